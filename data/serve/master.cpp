#include "elrom/serve/master.hpp"

#include <cmath>
#include <random>
#include <span>
#include <thread>

#include "elrom/base/digest.hpp"
#include "elrom/base/parallel.hpp"
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

std::string done(const std::string& lease, const Finished& finished, const std::string& fields) {
  Json result{{"version", finished.version},
              {"verdict", finished.verdict},
              {"reason", finished.reason},
              {"document", finished.document.empty() ? Json::object() : Json::parse(finished.document)},
              {"fields", fields}};
  return Json{{"lease", lease}, {"state", "done"}, {"result", result}}.dump();
}

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
  return Claimed{.run = run["id"], .lease = run["lease"], .inputs = run["inputs"].dump()};
}

void Master::give_back(const Claimed& claimed, const std::string& outcome, const std::stop_token& stop) {
  const auto target = "/runs/" + std::to_string(claimed.run) + "/outcome";
  const auto answer = insist(
      {.method = "POST", .target = target, .headers = headers("application/json"), .body = outcome}, stop);
  if (answer.status != 200)
    log_.warning("run " + std::to_string(claimed.run) + " was not taken back: " + answer.body);
}

bool Master::work_once(const std::stop_token& stop) {
  const auto claimed = claim(stop);
  if (!claimed) return false;
  std::string outcome;
  try {
    const auto finished = work_(*claimed);
    std::string digest;
    if (!finished.fields.empty()) {
      digest = base::sha256(std::as_bytes(std::span(finished.fields)));
      const auto sent = insist({.method = "PUT",
                                .target = "/fields/" + digest,
                                .headers = headers("application/x-hdf5"),
                                .body = finished.fields},
                               stop);
      if (sent.status >= 300)
        throw InputError(Problem{.what = "the repository refuses the fields", .found = sent.body});
    }
    outcome = done(claimed->lease, finished, digest);
  } catch (const Interrupted&) {
    throw;
  } catch (const InputError& error) {
    outcome = failed(claimed->lease, "failed", error.what());
  } catch (const NumericalError& error) {
    outcome = failed(claimed->lease, "failed", error.what());
  } catch (const std::exception& error) {
    outcome = failed(claimed->lease, "waiting", error.what());
  }
  give_back(*claimed, outcome, stop);
  return true;
}

void Master::work(const std::stop_token& stop) {
  while (!stop.stop_requested())
    if (!work_once(stop)) wait(options_.poll_s, stop);
}

Master::Work prediction_work(ResidentModel& model, const std::filesystem::path& folder) {
  return [&model, folder](const Claimed& claimed) {
    model.look();
    const auto open = model.now();
    if (!open) throw SystemError(Problem{.what = "no model yet", .advice = "train one with elrom-train run"});
    const auto name = "run " + std::to_string(claimed.run);
    const auto one = Json{{"case", name}, {"inputs", Json::parse(claimed.inputs)}}.dump();
    const auto judged = repository::judge_inputs(one, name, &open->schema(), &open->guard());
    std::vector<std::size_t> fields;
    for (std::size_t i = 0; i < open->fields().size(); ++i) fields.push_back(i);
    const auto values = open->predict(judged.inputs.values, fields, true, base::available_threads());
    static std::mutex hdf5;
    return Finished{
        .version = open->bundle().digest(),
        .verdict = std::string(model::name_of(judged.assessment->verdict)),
        .reason = judged.assessment->reason,
        .document = Json{{"distance", judged.assessment->distance}}.dump(),
        .fields = hdf_answer({*open, judged.inputs, *judged.assessment, fields, values}, hdf5, folder)};
  };
}

}  // namespace elrom::serve
