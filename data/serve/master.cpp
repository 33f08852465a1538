#include "elrom/serve/master.hpp"

#include <atomic>
#include <cmath>
#include <random>
#include <span>
#include <thread>

#include "elrom/base/digest.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/repository/rules.hpp"
#include "json_body.hpp"
#include "prediction_answer.hpp"

namespace elrom::serve {
namespace {

std::string random_key() {
  static thread_local std::random_device random;
  std::string key;
  for (int i = 0; i < 4; ++i) key += std::to_string(random()) + ".";
  return key;
}

/// In small pieces, so that a stop is not waited for.
void wait(double seconds, const std::stop_token& stop) {
  constexpr double piece_s = 0.05;
  for (double left = seconds; left > 0 && !stop.stop_requested(); left -= piece_s)
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left, piece_s)));
}

/// Somewhere below a limit that doubles with each try.
double backoff_s(int n_tries, double longest_s) {
  static thread_local std::minstd_rand random(std::random_device{}());
  constexpr double first_s = 0.1;
  return std::uniform_real_distribution(
      0.0, std::min(longest_s, first_s * std::exp2(std::min(n_tries, 20))))(random);
}

/// The server is away, busy or in trouble: not what was asked is wrong.
bool may_be_tried_again(int status) { return status == 408 || status == 429 || status >= 500; }

std::string failed(const std::string& lease, const char* state, const std::string& reason) {
  return Json{{"lease", lease}, {"state", state}, {"reason", reason}, {"retry_after_s", 10}}.dump();
}

std::string done(const std::string& lease, const Finished& finished, const std::string& fields,
                 std::vector<std::string> ask) {
  Json result{{"version", finished.version},
              {"verdict", finished.verdict},
              {"reason", finished.reason},
              {"document", finished.document.empty() ? Json::object() : Json::parse(finished.document)},
              {"fields", fields}};
  ask.insert(ask.end(), finished.ask.begin(), finished.ask.end());
  return Json{{"lease", lease}, {"state", "done"}, {"result", result}, {"ask", ask}}.dump();
}

/// Renews a lease as long as it lives, by a connection of its own.
class Lease {
 public:
  Lease(const MasterOptions& options, const http::Request& renewal, const std::stop_token& stop)
      : forward_(stop, [this] { unwanted_.request_stop(); }),
        thread_([&options, renewal, this](const std::stop_token& over) {
          http::Client client(options.url, options.client);
          const double pause_s = options.lease_s / 3;
          for (wait(pause_s, over); !over.stop_requested(); wait(pause_s, over)) renew(client, renewal);
        }) {}

  /// Requested when the run is another's by now, too.
  [[nodiscard]] std::stop_token unwanted() const { return unwanted_.get_token(); }
  [[nodiscard]] bool is_lost() const { return lost_; }

 private:
  void renew(http::Client& client, const http::Request& renewal) {
    try {
      if (client.send(renewal).status != 409) return;
      lost_ = true;
      unwanted_.request_stop();
    } catch (const SystemError&) {  // the repository is away; the next renewal may find it
    }
  }

  std::stop_source unwanted_;
  std::atomic<bool> lost_ = false;
  std::stop_callback<std::function<void()>> forward_;
  std::jthread thread_;  //!< the last: it uses the others
};

}  // namespace

Master::Master(MasterOptions options, Work work, Log& log)
    : options_(std::move(options)),
      work_(std::move(work)),
      log_(log),
      client_(options_.url, options_.client) {}

http::Headers Master::headers(const std::string& media) const {
  return {{"Authorization", "Bearer " + options_.token},
          {"Content-Type", media},
          {"Idempotency-Key", random_key()}};
}

http::Response Master::insist(const http::Request& request, const std::stop_token& stop) {
  for (int n_tries = 0;; ++n_tries) {
    std::string trouble;
    try {
      auto answer = client_.send(request);
      if (!may_be_tried_again(answer.status)) return answer;
      trouble = "status " + std::to_string(answer.status);
    } catch (const SystemError& error) {
      trouble = error.what();
    }
    log_.detail(request.method + " " + request.target + ": " + trouble + "; trying again");
    wait(backoff_s(n_tries, options_.longest_wait_s), stop);
    if (stop.stop_requested()) throw Interrupted("stopped while the repository was away");
  }
}

http::Response Master::expect(const std::string& target, const std::stop_token& stop) {
  auto answer = insist({.method = "GET", .target = target, .headers = headers("application/json")}, stop);
  if (answer.status == 200) return answer;
  throw InputError(Problem{.what = "the repository does not answer", .where = target, .found = answer.body});
}

SourceResult Master::fetch(std::int64_t result, const std::stop_token& stop) {
  const auto document = Json::parse(expect("/results/" + std::to_string(result), stop).body);
  SourceResult source{.id = result,
                      .model = document["model"],
                      .version = document["version"],
                      .document = document["document"].dump(),
                      .fields = {}};
  if (document["fields"].is_string())
    source.fields = expect("/fields/" + document["fields"].get<std::string>(), stop).body;
  return source;
}

std::optional<Claimed> Master::claim(const std::stop_token& stop) {
  const Json body{{"model", options_.model}, {"worker", options_.worker}, {"lease_s", options_.lease_s}};
  const auto answer = insist(
      {.method = "POST", .target = "/claims", .headers = headers("application/json"), .body = body.dump()},
      stop);
  if (answer.status == 204) return std::nullopt;
  if (answer.status != 201)
    throw InputError(
        Problem{.what = "the repository gives out no run", .where = options_.url, .found = answer.body});
  const auto run = Json::parse(answer.body);
  Claimed claimed{.run = run["id"],
                  .lease = run["lease"],
                  .inputs = run["inputs"].dump(),
                  .inputs_digest = run["inputs_digest"]};
  if (run["load"].is_number()) claimed.load = run["load"];
  for (const auto& id : run["sources"]) claimed.sources.push_back(fetch(id, stop));
  return claimed;
}

void Master::give_back(const Claimed& claimed, const std::string& outcome, const std::stop_token& stop) {
  const auto target = "/runs/" + std::to_string(claimed.run) + "/outcome";
  const auto answer = insist(
      {.method = "POST", .target = target, .headers = headers("application/json"), .body = outcome}, stop);
  if (answer.status != 200)
    log_.warning("run " + std::to_string(claimed.run) + " was not taken back: " + answer.body);
}

std::string Master::send_fields(const std::string& file, const std::stop_token& stop) {
  if (file.empty()) return {};
  auto digest = base::sha256(std::as_bytes(std::span(file)));
  const auto sent = insist({.method = "PUT",
                            .target = "/fields/" + digest,
                            .headers = headers("application/x-hdf5"),
                            .body = file},
                           stop);
  if (sent.status < 300) return digest;
  throw WrongResultError(Problem{.what = "the repository refuses the fields", .found = sent.body});
}

/// Works on the run. @return what is to be told of it; empty: it is another's by now
std::string Master::outcome_of(const Claimed& claimed, const std::stop_token& stop) {
  const Lease lease(options_,
                    {.method = "PUT",
                     .target = "/runs/" + std::to_string(claimed.run) + "/lease",
                     .headers = headers("application/json"),
                     .body = Json{{"lease", claimed.lease}, {"lease_s", options_.lease_s}}.dump()},
                    stop);
  const auto ends = [&](const char* state, const std::exception& error) {
    log_.warning("run " + std::to_string(claimed.run) + ", " + state + ": " + error.what());
    return failed(claimed.lease, state, error.what());
  };
  try {
    const auto finished = work_(claimed, lease.unwanted());
    return done(claimed.lease, finished, send_fields(finished.fields, stop), options_.then);
  } catch (const Interrupted&) {
    if (!lease.is_lost()) throw;
    log_.warning("run " + std::to_string(claimed.run) + " is another's by now");
    return {};
  } catch (const WrongResultError& error) {
    return ends("quarantined", error);
  } catch (const InputError& error) {
    return ends("failed", error);
  } catch (const NumericalError& error) {
    return ends("failed", error);
  } catch (const std::exception& error) {
    return ends("waiting", error);
  }
}

/// One try: if the repository is away too, the lease ends by itself.
void Master::return_unfinished(const Claimed& claimed) {
  try {
    (void)client_.send({.method = "POST",
                        .target = "/runs/" + std::to_string(claimed.run) + "/outcome",
                        .headers = headers("application/json"),
                        .body = failed(claimed.lease, "waiting", "its master was stopped")});
  } catch (const SystemError& error) {
    log_.detail(error.what());
  }
}

bool Master::work_once(const std::stop_token& stop) {
  const auto claimed = claim(stop);
  if (!claimed) return false;
  log_.info("run " + std::to_string(claimed->run) + " begun");
  std::string outcome;
  try {
    outcome = outcome_of(*claimed, stop);
  } catch (const Interrupted&) {
    return_unfinished(*claimed);
    throw;
  }
  if (!outcome.empty()) give_back(*claimed, outcome, stop);
  return true;
}

void Master::work(const std::stop_token& stop) {
  while (!stop.stop_requested())
    if (!work_once(stop)) wait(options_.poll_s, stop);
}

namespace {

/// ELROM does not answer there, whoever is asked instead.
Finished not_answered(const OpenModel& open, const model::Assessment& assessment,
                      const std::vector<std::string>& asked) {
  const auto instead =
      asked.empty() ? "nobody is asked instead" : "a run of " + base::join(asked, ", ") + " is asked for";
  return {.version = open.bundle().digest(),
          .verdict = std::string(model::name_of(assessment.verdict)),
          .reason = assessment.reason + "; " + instead,
          .document = Json{{"distance", assessment.distance}, {"asked", asked}}.dump(),
          .ask = asked};
}

}  // namespace

Master::Work prediction_work(ResidentModel& model, const PredictionWork& options) {
  return [&model, options](const Claimed& claimed, const std::stop_token& /*stop*/) {
    model.look();
    const auto open = model.now();
    if (!open) throw SystemError(Problem{.what = "no model yet", .advice = "train one with elrom-train run"});
    const auto name = "run " + std::to_string(claimed.run);
    const auto one = Json{{"case", name}, {"inputs", Json::parse(claimed.inputs)}}.dump();
    const auto judged = repository::judge_inputs(one, name, &open->schema(), &open->guard());
    if (judged.assessment->verdict == model::Verdict::outside)
      return not_answered(*open, *judged.assessment, options.outside);
    std::vector<std::size_t> fields;
    for (std::size_t i = 0; i < open->fields().size(); ++i) fields.push_back(i);
    const auto values = open->predict(judged.inputs.values, fields, true, base::available_threads());
    static std::mutex hdf5;
    return Finished{.version = open->bundle().digest(),
                    .verdict = std::string(model::name_of(judged.assessment->verdict)),
                    .reason = judged.assessment->reason,
                    .document = Json{{"distance", judged.assessment->distance}}.dump(),
                    .fields = hdf_answer({*open, judged.inputs, *judged.assessment, fields, values}, hdf5,
                                         options.folder)};
  };
}

}  // namespace elrom::serve
