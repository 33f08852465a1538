// bench-serve: elrom-serve under faults and under load. Calls are repeated, cut off, held back, and the
// server is killed while they are on their way; afterwards every one must be there once. Then what fields
// cost, up, down and predicted, how soon a page shows what a slider did, and what many clients at once are
// told.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "elrom/base/digest.hpp"
#include "elrom/base/random.hpp"
#include "elrom/base/text.hpp"
#include "elrom/http/client.hpp"
#include "elrom/serve/resident_model.hpp"
#include "support/benchmark.hpp"
#include "support/outcome.hpp"
#include "support/postgresql_server.hpp"
#include "support/raw_connection.hpp"
#include "support/sample_bundle.hpp"
#include "support/serving.hpp"
#include "support/temporary_folder.hpp"
#include "support/tiny_disk.hpp"

namespace elrom::benchmark {
namespace {

using Json = nlohmann::ordered_json;
using test::Serving;

struct Options {
  bool small = false;
  std::string json, bundle;
  [[nodiscard]] int calls() const { return small ? 600 : 10000; }
  [[nodiscard]] double load_seconds() const { return small ? 3 : 60; }
};

/// A server with a folder and a token of its own, on a disk of its own where that may be mounted.
struct Place {
  test::TemporaryFolder folder;
  test::TinyDisk disk;
  std::string data = (folder / "disk/data").string();
  std::vector<std::string> arguments{"--data", data, "--quiet", "--requests-per-second", "1000000"};
  std::string token;
  std::unique_ptr<Serving> serving;

  Place(const std::string& database, const std::string& bundle, const std::string& disk_size = "3g")
      : disk(folder / "disk", disk_size) {
    const auto program = sibling("elrom-serve").string();
    arguments.insert(arguments.end(), {"--database", database, "--model", bundle});
    token = base::trim(test::outcome_of("'" + program + "' --data " + data + " --database '" + database +
                                        "' --make-token bench=admin")
                           .text);
    serving = std::make_unique<Serving>(program, arguments);
  }
  [[nodiscard]] http::Headers headers(const std::string& key) const {
    return {
        {"Authorization", "Bearer " + token}, {"Content-Type", "application/json"}, {"Idempotency-Key", key}};
  }
  [[nodiscard]] unsigned short port() const {
    return static_cast<unsigned short>(std::stoi(serving->url().substr(serving->url().rfind(':') + 1)));
  }
  [[nodiscard]] Json get(const std::string& target) const {
    return Json::parse(
        http::Client(serving->url()).send({.method = "GET", .target = target, .headers = headers("")}).body);
  }
  /// All of a list.
  [[nodiscard]] std::vector<Json> all(const std::string& target) const {
    std::vector<Json> items;
    for (Json next = 0; !next.is_null();) {
      auto part = get(target + (target.find('?') == std::string::npos ? "?" : "&") +
                      "limit=1000&after=" + next.dump());
      for (auto& item : part["items"]) items.push_back(std::move(item));
      next = part["next"];
    }
    return items;
  }
};

/// Kills the server without warning, again and again, as long as it lives.
class Killer {
 public:
  explicit Killer(Place& place)
      : thread_([&place, this](const std::stop_token& stop) {
          base::Random random(base::Seed(11).derive("killer"));
          while (!stop.stop_requested()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(400 + random.below(900)));
            place.serving->end(SIGKILL);
            place.serving->begin();
            ++n_kills;
          }
        }) {}
  std::atomic<int> n_kills = 0;

 private:
  std::jthread thread_;
};

/// Takes all the room on the server's disk for a moment, again and again.
class Filler {
 public:
  explicit Filler(const Place& place)
      : thread_([&place, this](const std::stop_token& stop) {
          base::Random random(base::Seed(12).derive("filler"));
          while (place.disk.mounted() && !stop.stop_requested()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(800 + random.below(1500)));
            ++n_times;
            const test::Ballast ballast(place.folder / "disk/ballast");
            std::this_thread::sleep_for(std::chrono::milliseconds(200));
          }
        }) {}
  std::atomic<int> n_times = 0;

 private:
  std::jthread thread_;
};

/// A client that meets every fault and does not give up.
class FaultyClient {
 public:
  FaultyClient(const Place& place, std::uint64_t number)
      : place_(place), random_(base::Seed(13).derive("client").derive(number)) {}

  /// Until it is answered; then perhaps again. @return the last answer
  http::Response write(const std::string& target, const Json& body, const std::string& key) {
    const http::Request request{
        .method = "POST", .target = target, .headers = place_.headers(key), .body = body.dump()};
    if (random_.below(4) == 0) cut(request);
    auto answer = insist(request);
    if (random_.below(4) == 0) {
      const auto again = insist(request);
      // A claim that found nothing did nothing, and is not remembered: later there may be a run.
      if (answer.status != 204 && (again.body != answer.body || again.status != answer.status)) ++n_unlike;
    }
    // Another one of this client's, which everybody believes to be over.
    if (!old_.target.empty() && random_.below(4) == 0) (void)insist(old_);
    if (random_.below(4) == 0) old_ = request;
    return answer;
  }

  int n_unlike = 0, n_cut = 0;

 private:
  /// Sends a part of it, or all, and hangs up.
  void cut(const http::Request& request) {
    ++n_cut;
    std::string text = request.method + " " + request.target +
                       " HTTP/1.1\r\nHost: x\r\nContent-Length: " + std::to_string(request.body.size()) +
                       "\r\n";
    for (const auto& [name, value] : request.headers) text += name + ": " + value + "\r\n";
    text += "\r\n" + request.body;
    try {
      const test::RawConnection connection(place_.port());
      connection.send(text.substr(0, random_.below(2) == 0 ? text.size() : random_.below(text.size())));
    } catch (const std::runtime_error&) {  // the server is away
    }
  }

  http::Response insist(const http::Request& request) {
    for (int n_tries = 0; n_tries < 1000; ++n_tries) {
      try {
        if (!client_) client_.emplace(place_.serving->url(), http::ClientOptions{.timeout_seconds = 10});
        auto answer = client_->send(request);
        if (answer.status < 500) return answer;
      } catch (const SystemError&) {
        client_.reset();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5 + random_.below(50)));
    }
    throw SystemError("the server does not come back");
  }

  const Place& place_;
  base::Random random_;
  std::optional<http::Client> client_;
  http::Request old_;
};

/// Number i's scenario, run and result, each by one call; a tenth of the masters die with their run.
void work_off(FaultyClient& client, int i, base::Random& random) {
  const auto name = "s" + std::to_string(i);
  const Json scenario{{"name", name}, {"inputs", {{"steam [kg/s]", i}}}};
  const auto made = client.write("/scenarios", scenario, "scenario-" + name);
  if (made.status != 201) return;
  const auto run =
      client.write("/runs", {{"scenario", Json::parse(made.body)["id"]}, {"model", name}}, "run-" + name);
  if (run.status != 201) return;
  int attempt = 0;
  const auto take = [&](int lease_s) {
    return client.write("/claims", {{"model", name}, {"worker", "w"}, {"lease_s", lease_s}},
                        "claim-" + name + "-" + std::to_string(attempt++));
  };
  if (random.below(10) == 0) (void)take(1);  // this master is dead
  for (int n_looks = 0; n_looks < 100; ++n_looks) {
    const auto taken = take(10);
    if (taken.status != 201) {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      continue;
    }
    const auto held = Json::parse(taken.body);
    const Json outcome{{"lease", held["lease"]},
                       {"state", "done"},
                       {"result", {{"version", "1"}, {"document", {{"number", i}}}}}};
    const auto done = client.write("/runs/" + held["id"].dump() + "/outcome", outcome,
                                   "outcome-" + name + "-" + std::to_string(attempt));
    if (done.status != 409) return;  // else the server was away for longer than the lease
  }
}

struct FaultedCalls {
  int of = 0, passed = 0, kills = 0, cut = 0, full = 0, unlike = 0;
  double seconds = 0;
};

/// What is there once, as it was sent: scenarios, their runs and their results.
int count_sound(const Place& place, int n) {
  std::map<std::string, int> scenarios;
  std::map<std::int64_t, std::string> names;
  for (const auto& one : place.all("/scenarios")) {
    const std::string name = one["name"];
    names[one["id"]] = name;
    if (one["inputs"]["steam [kg/s]"].get<double>() == std::stod(name.substr(1))) ++scenarios[name];
  }
  std::map<std::string, int> runs, done;
  for (const auto& one : place.all("/runs")) {
    const auto name = names[one["scenario"]];
    if (one["model"] != name) continue;
    ++runs[name];
    if (one["state"] != "done") continue;
    const auto results = place.get("/scenarios/" + one["scenario"].dump() + "/results")["items"];
    done[name] += results.size() == 1 && results[0]["document"]["number"] == std::stoi(name.substr(1));
  }
  int n_sound = 0;
  for (int i = 0; i < n; ++i) {
    const auto name = "s" + std::to_string(i);
    n_sound += (scenarios[name] == 1) + (runs[name] == 1) + 2 * (done[name] == 1);  // claimed and given back
  }
  return n_sound;
}

FaultedCalls faulted_calls(const std::string& database, const Options& options) {
  constexpr int n_clients = 8, calls_each = 4;
  Place place(database, "none", "100m");  // soon full
  const int n = options.calls() / calls_each;
  FaultedCalls result{.of = n * calls_each};
  std::atomic<int> next = 0;
  std::mutex mutex;
  int n_unlike = 0;
  const Stopwatch clock;
  {
    Killer killer(place);
    Filler filler(place);
    std::vector<std::jthread> clients;
    for (int c = 0; c < n_clients; ++c)
      clients.emplace_back([&, c] {
        FaultyClient client(place, static_cast<std::uint64_t>(c));
        base::Random random(base::Seed(17).derive(static_cast<std::uint64_t>(c)));
        for (int i = next++; i < n; i = next++) work_off(client, i, random);
        const std::scoped_lock lock(mutex);
        n_unlike += client.n_unlike;
        result.cut += client.n_cut;
      });
    clients.clear();
    result.kills = killer.n_kills;
    result.full = filler.n_times;
  }
  result.seconds = clock.seconds();
  result.unlike = n_unlike;
  result.passed = count_sound(place, n) - n_unlike;
  return result;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

Json inputs_of(const serve::OpenModel& model) {
  Json inputs;
  const auto& schema = model.schema();
  for (std::size_t i = 0; i < schema.size(); ++i)
    inputs[schema[i].name + " [" + schema[i].unit + "]"] =
        0.5 * (model.guard().low()[i] + model.guard().high()[i]);
  return inputs;
}

/// A master beside the server, killed and begun again.
class MasterProcess {
 public:
  MasterProcess(const Place& place, const std::string& bundle) {
    base::write_text(place.folder / "token", place.token);
    command_ = {sibling("elrom-master").string(),
                "elrom",
                "--repository",
                place.serving->url(),
                "--token-file",
                (place.folder / "token").string(),
                "--bundle",
                bundle,
                "--lease",
                "1",
                "--work",
                (place.folder / "work").string()};
    begin();
  }
  ~MasterProcess() { end(); }
  MasterProcess(const MasterProcess&) = delete;
  MasterProcess& operator=(const MasterProcess&) = delete;

  /// As its runs name it.
  [[nodiscard]] std::string worker() const { return "master-" + std::to_string(process_); }
  void kill() {
    end();
    begin();
  }

 private:
  void begin() {
    std::vector<char*> pointers;
    for (auto& word : command_) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t silent;
    ::posix_spawn_file_actions_init(&silent);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
      ::posix_spawn_file_actions_addopen(&silent, stream, "/dev/null", O_WRONLY, 0);
    const int fault = ::posix_spawn(&process_, pointers[0], &silent, nullptr, pointers.data(), environ);
    ::posix_spawn_file_actions_destroy(&silent);
    if (fault != 0) throw SystemError("elrom-master does not start");
  }
  void end() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }

  std::vector<std::string> command_;
  pid_t process_ = -1;
};

/// A master that has a run, somewhere on its way; a run loses two at most, or nobody would come to its end.
bool kill_a_worker(const Place& place, std::span<MasterProcess> masters, base::Random& random) {
  std::this_thread::sleep_for(std::chrono::milliseconds(random.below(60)));
  const auto running = place.all("/runs?state=running");
  if (running.empty()) return false;
  const auto& run = running[random.below(running.size())];
  const auto victim = std::ranges::find(masters, run["worker"].get<std::string>(), &MasterProcess::worker);
  if (victim == masters.end() || run["attempts"] > 2) return false;
  victim->kill();
  return true;
}

struct FaultedRuns {
  int of = 0, passed = 0, kills = 0;
  double seconds = 0;
};

/// Runs that real masters work off while they and the server are killed: each has one result, whose fields
/// are there.
FaultedRuns faulted_runs(const std::string& database, const std::string& bundle, const Options& options) {
  Place place(database, bundle);
  FaultedRuns result{.of = options.small ? 20 : 200};
  const auto inputs = inputs_of(serve::OpenModel(bundle));
  const auto post = [&](const std::string& target, const Json& body, const std::string& key) {
    const auto answer =
        http::Client(place.serving->url())
            .send({.method = "POST", .target = target, .headers = place.headers(key), .body = body.dump()});
    if (answer.status != 201) throw SystemError("not taken: " + answer.body);
  };
  for (int i = 1; i <= result.of; ++i) {
    auto own = inputs;
    own.begin().value() = own.begin()->get<double>() * (1 + 1e-4 * i);
    post("/scenarios", {{"name", "s" + std::to_string(i)}, {"inputs", own}}, "s" + std::to_string(i));
    post("/runs", {{"scenario", i}, {"model", "elrom"}}, "r" + std::to_string(i));
  }
  const Stopwatch clock;
  {
    std::array<MasterProcess, 3> masters{MasterProcess(place, bundle), MasterProcess(place, bundle),
                                         MasterProcess(place, bundle)};
    const auto is_open = [&] {
      return !place.all("/runs?state=waiting").empty() || !place.all("/runs?state=running").empty();
    };
    for (base::Random random(base::Seed(19).derive("masters")); clock.seconds() < 600 && is_open();)
      if (kill_a_worker(place, masters, random) && ++result.kills % 5 == 0) {
        place.serving->end(SIGKILL);
        place.serving->begin();
      }
  }
  result.seconds = clock.seconds();
  for (const auto& one : place.all("/scenarios")) {
    const auto results = place.get("/scenarios/" + one["id"].dump() + "/results")["items"];
    if (results.size() != 1 || !results[0]["fields"].is_string()) continue;
    const auto fields = http::Client(place.serving->url())
                            .send({.method = "GET",
                                   .target = "/fields/" + results[0]["fields"].get<std::string>(),
                                   .headers = place.headers("")});
    result.passed += fields.status == 200;
  }
  return result;
}

/// Boundary conditions with one mistake each: of every input, every kind that the schema and physics know.
std::vector<Json> mistaken(const Json& inputs) {
  std::vector<Json> all;
  for (const auto& [name, value] : inputs.items()) {
    const auto add = [&, &key = name](const std::string& other, const Json& wrong) {
      auto one = inputs;
      one.erase(key);
      if (!other.empty()) one[other] = wrong;
      all.push_back(std::move(one));
    };
    for (const Json& wrong :
         {Json(-1e3), Json(1e30), Json("much"), Json(nullptr), Json::array({value}), Json(true)})
      add(name, wrong);
    const auto bare = name.substr(0, name.find(" ["));
    add("", {});
    for (const char* unit : {" [furlong]", " [A]", " ["}) add(bare + unit, value);
    add("no_" + name, value);
  }
  return all;
}

struct WrongData {
  std::size_t stopped = 0, of = 0;
};

/// Refused, in quarantine with the reason, and no scenario that a model could be asked about.
WrongData wrong_data(const Place& place, const Json& inputs) {
  http::Client client(place.serving->url());
  WrongData result;
  const auto n_before = place.all("/scenarios").size();
  for (const auto& wrong : mistaken(inputs)) {
    const auto name = "wrong-" + std::to_string(result.of++);
    const auto answer = client.send({.method = "POST",
                                     .target = "/scenarios",
                                     .headers = place.headers(name),
                                     .body = Json{{"name", name}, {"inputs", wrong}}.dump()});
    const bool stopped = answer.status == 422 && Json::parse(answer.body).contains("quarantine");
    if (!stopped) fmt::print("not stopped: {}\n{}", wrong.dump(), answer.body);
    result.stopped += stopped;
  }
  if (place.all("/scenarios").size() != n_before) throw SystemError("a wrong scenario was kept");
  return result;
}

/// Nine fields up, as a file of their own each time, and down again.
double fields_ms(const Place& place, const Json& inputs, int n) {
  http::Client client(place.serving->url());
  std::vector<double> times;
  for (int i = 0; i < n; ++i) {
    auto headers = place.headers("");
    headers.emplace_back("Accept", "application/x-hdf5");
    const auto file =
        client
            .send({.method = "POST",
                   .target = "/predictions",
                   .headers = headers,
                   .body = Json{{"case", "c" + std::to_string(i)}, {"inputs", inputs}, {"intervals", false}}
                               .dump()})
            .body;
    const auto target = "/fields/" + base::sha256(std::as_bytes(std::span(file)));
    headers[1].second = "application/x-hdf5";
    const Stopwatch clock;
    const auto up = client.send({.method = "PUT", .target = target, .headers = headers, .body = file});
    const auto down = client.send({.method = "GET", .target = target, .headers = headers});
    times.push_back(1000 * clock.seconds());
    if (up.status != 201 || down.body != file) throw SystemError("fields did not come back: " + up.body);
  }
  return median(times);
}

/// All nine fields as binary, over the wire.
double prediction_ms(const Place& place, const Json& inputs, int n) {
  http::Client client(place.serving->url());
  auto headers = place.headers("");
  headers.emplace_back("Accept", "application/octet-stream");
  std::vector<double> times;
  for (int i = 0; i < n; ++i) {
    const Stopwatch clock;
    const auto answer = client.send({.method = "POST",
                                     .target = "/predictions",
                                     .headers = headers,
                                     .body = Json{{"inputs", inputs}, {"intervals", false}}.dump()});
    times.push_back(1000 * clock.seconds());
    if (answer.status != 200) throw SystemError("no prediction: " + answer.body);
  }
  return median(times);
}

/// Nine fields by the resident predictor itself.
double resident_ms(const serve::OpenModel& model, int n) {
  std::vector<double> inputs;
  std::vector<std::size_t> fields;
  for (std::size_t i = 0; i < model.schema().size(); ++i)
    inputs.push_back(0.5 * (model.guard().low()[i] + model.guard().high()[i]));
  for (std::size_t i = 0; i < model.fields().size(); ++i) fields.push_back(i);
  std::vector<double> times;
  for (int i = 0; i < n; ++i) {
    const Stopwatch clock;
    (void)model.predict(inputs, fields, false, base::available_threads());
    times.push_back(1000 * clock.seconds());
  }
  return median(times);
}

struct Load {
  int clients = 64;
  std::size_t requests = 0, errors = 0;
  double median_ms = 0, p99_ms = 0;
};

Load load(const Place& place, const Json& inputs, double seconds) {
  Load result;
  std::vector<double> times;
  std::mutex mutex;
  std::vector<std::jthread> clients;
  const Stopwatch clock;
  for (int c = 0; c < result.clients; ++c)
    clients.emplace_back([&, c] {
      http::Client client(place.serving->url());
      auto binary = place.headers("");
      binary.emplace_back("Accept", "application/octet-stream");
      const auto body = Json{{"inputs", inputs}, {"fields", {"pressure"}}, {"intervals", false}}.dump();
      std::vector<double> own;
      std::size_t n_errors = 0;
      for (int i = 0; clock.seconds() < seconds; ++i) {
        const auto name = std::to_string(c) + "-" + std::to_string(i);
        const std::vector<http::Request> kinds{
            {.method = "GET", .target = "/scenarios?limit=10", .headers = place.headers("")},
            {.method = "POST", .target = "/predictions", .headers = binary, .body = body},
            {.method = "GET", .target = "/runs?limit=10", .headers = place.headers("")},
            {.method = "POST",
             .target = "/scenarios",
             .headers = place.headers(name),
             .body = Json{{"name", name}, {"inputs", inputs}}.dump()}};
        const Stopwatch one;
        try {
          n_errors += client.send(kinds[static_cast<std::size_t>(i) % kinds.size()]).status >= 300;
        } catch (const SystemError&) {
          ++n_errors;
        }
        own.push_back(1000 * one.seconds());
      }
      const std::scoped_lock lock(mutex);
      times.insert(times.end(), own.begin(), own.end());
      result.errors += n_errors;
    });
  clients.clear();
  std::ranges::sort(times);
  result.requests = times.size();
  result.median_ms = median(times);
  result.p99_ms = times[static_cast<std::size_t>(0.99 * static_cast<double>(times.size() - 1))];
  return result;
}

/// From a key that moves a slider to the new picture, in a headless browser. null: there is none, or no page.
Json slider(const std::string& bundle, const Options& options) {
  const auto bin = sibling("elrom-serve").parent_path();
  const auto outcome = test::outcome_of(
      std::string("node '" ELROM_SOURCE_DIR "/tests/page/slider.mjs' '") + bin.string() + "' '" +
      (bin.parent_path() / "page-packages").string() + "' '" + bundle + "' " + (options.small ? "4" : "22"));
  const auto said = base::split(base::trim(outcome.text), '\n').back();
  if (outcome.status != 0) {
    fmt::print("slider not measured: {}\n", said);
    return nullptr;
  }
  const auto figures = Json::parse(said);
  fmt::print("slider to new picture in Chromium: median {:.0f} ms, 95 % within {:.0f} ms of {} presses\n",
             figures["median_ms"].get<double>(), figures["p95_ms"].get<double>(), figures["n"].get<int>());
  return figures;
}

Json measure_faults(const std::string& name, const std::string& database, const Options& options) {
  const auto calls = faulted_calls(database, options);
  fmt::print(
      "{}: {} of {} faulted calls there once; the server was killed {} times, the disk full {} times, {} calls "
      "were cut off; {}\n",
      name, calls.passed, calls.of, calls.kills, calls.full, calls.cut, base::duration(calls.seconds));
  return {{"passed", calls.passed},  {"of", calls.of},   {"kills", calls.kills},
          {"disk_full", calls.full}, {"cut", calls.cut}, {"seconds", calls.seconds}};
}

Json measure_runs(const std::string& name, const std::string& database, const std::string& bundle,
                  const Options& options) {
  const auto runs = faulted_runs(database, bundle, options);
  fmt::print("{}: {} of {} runs done once while masters and server were killed {} times; {}\n", name,
             runs.passed, runs.of, runs.kills, base::duration(runs.seconds));
  return {{"passed", runs.passed}, {"of", runs.of}, {"kills", runs.kills}, {"seconds", runs.seconds}};
}

std::string bundle_of(const Options& options, const test::TemporaryFolder& folder) {
  if (!options.bundle.empty()) return std::filesystem::absolute(options.bundle).string();
  const auto path = folder / "sample.elrom";
  test::sample_bundle(
      {.n_x = 20, .n_y = 42, .n_planes = 66, .n_inputs = 26, .n_submodels = 4, .n_units = 64, .wave = 0.6})
      .write(path);
  return path.string();
}

Json measure(const Options& options) {
  Json figures;
  const test::TemporaryFolder folder;
  const auto bundle = bundle_of(options, folder);
  figures["faulted_calls"] = measure_faults("SQLite", "sqlite", options);
  figures["faulted_runs"] = measure_runs("SQLite", "sqlite", bundle, options);
  if (test::PostgresqlServer::available()) {
    figures["faulted_calls_postgresql"] =
        measure_faults("PostgreSQL", test::PostgresqlServer().url(), options);
    figures["faulted_runs_postgresql"] =
        measure_runs("PostgreSQL", test::PostgresqlServer().url(), bundle, options);
  }
  const serve::OpenModel model(bundle);
  const auto inputs = inputs_of(model);
  Place place("sqlite", bundle);
  const int n = options.small ? 5 : 40;
  const auto wrong = wrong_data(place, inputs);
  figures["wrong_data"] = {{"stopped", wrong.stopped}, {"of", wrong.of}};
  fmt::print("{} of {} operating points with a mistake stopped\n", wrong.stopped, wrong.of);
  figures["fields_ms"] = fields_ms(place, inputs, n);
  figures["prediction_ms"] = resident_ms(model, n);
  figures["prediction_wire_ms"] = prediction_ms(place, inputs, n);
  fmt::print("fields up and down {:.1f} ms; prediction of {} fields {:.2f} ms, over the wire {:.1f} ms\n",
             figures["fields_ms"].get<double>(), model.fields().size(),
             figures["prediction_ms"].get<double>(), figures["prediction_wire_ms"].get<double>());
  const auto pictures = slider(bundle, options);
  figures["slider_ms"] = pictures.is_null() ? Json() : pictures["median_ms"];
  figures["slider"] = pictures;
  const auto busy = load(place, inputs, options.load_seconds());
  figures["clients"] = {{"n", busy.clients},           {"seconds", options.load_seconds()},
                        {"requests", busy.requests},   {"errors", busy.errors},
                        {"median_ms", busy.median_ms}, {"p99_ms", busy.p99_ms}};
  fmt::print("{} clients for {} s: {} requests, {} errors, median {:.1f} ms, 99 % {:.0f} ms\n", busy.clients,
             options.load_seconds(), busy.requests, busy.errors, busy.median_ms, busy.p99_ms);
  const int status = place.serving->end(SIGTERM);
  if (status != 0) throw SystemError("the server stopped with status " + std::to_string(status));
  return figures;
}

int run(int argc, char** argv) {
  Options options;
  CommandLine line("Measures elrom-serve: faulted calls, fields up and down, predictions, many clients.");
  line.add("--small", options.small, "600 calls and 3 s of load instead of 10,000 and 60");
  line.add("--bundle", options.bundle, "Bundle that predicts [default: random networks of the full size]");
  line.add("--json", options.json, "Write the figures here");
  if (const auto status = line.parse(argc, argv)) return *status;
  const auto figures = measure(options);
  if (!options.json.empty()) base::write_text(options.json, figures.dump(2) + "\n");
  return 0;
}

}  // namespace
}  // namespace elrom::benchmark

int main(int argc, char** argv) {
  return elrom::base::run_app("bench-serve", [&] { return elrom::benchmark::run(argc, argv); });
}
