#include "fuzz_service.hpp"

#include <algorithm>
#include <memory>
#include <span>
#include <stdexcept>

#include "../../data/serve/json_body.hpp"
#include "../../data/serve/problem.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/http/client.hpp"
#include "elrom/http/server.hpp"
#include "elrom/ingest/judge_fields.hpp"
#include "elrom/repository/rules.hpp"
#include "elrom/serve/service.hpp"
#include "memory_file.hpp"
#include "support/raw_connection.hpp"
#include "support/sample_bundle.hpp"
#include "support/sample_run.hpp"

namespace elrom::faults {
namespace {

void expect(bool holds, const std::string& what) {
  if (!holds) throw std::logic_error("fuzz: " + what);
}

std::string text_of(Bytes input) { return {reinterpret_cast<const char*>(input.data()), input.size()}; }

/// A service with a small model, in memory; one a process.
struct Target {
  std::filesystem::path folder = memory_folder() / ("service" + std::to_string(::getpid()));
  std::unique_ptr<serve::Service> service;
  std::string token;

  Target() {
    std::filesystem::create_directories(folder / "page");
    test::write_bytes(folder / "page/index.html", "<p>");
    test::write_bytes(folder / "hidden.txt", "treasure");
    test::sample_bundle({}).write(folder / "model.elrom");
    service = std::make_unique<serve::Service>(
        serve::ServiceOptions{.repository = {.folder = folder / "data"},
                              .model = folder / "model.elrom",
                              .page = folder / "page",
                              .judge_upload = [](const auto& file, const auto& /*bundle*/) {
                                repository::judge_fields(file, "");
                              }});
    service->model().look();
    service->repository().write(
        [&](repository::Transaction& t) { token = t.make_token("fuzz", repository::Role::admin); });
  }
};
Target& target() {
  static Target one;
  return one;
}

void fuzz_target(Bytes input) {
  const auto found = http::parse_target(text_of(input));
  if (!found) return;
  for (const auto& segment : found->segments)
    expect(segment != ".." && segment != "." && segment.find('/') == std::string::npos &&
               segment.find('\0') == std::string::npos,
           "a path that leads elsewhere");
}

void fuzz_json_body(Bytes input) {
  try {
    const serve::JsonBody body(text_of(input), {"name", "inputs", "load", "sources", "fields", "flag"});
    (void)body.text_or("name", "");
    (void)body.number_or("load", 0);
    (void)body.wholes("sources");
    (void)body.texts("fields");
    (void)body.flag_or("flag", false);
    (void)body.object("inputs", {"a"});
  } catch (const Error&) {
  }
}

/// "METHOD target", "Name: value" lines, an empty line, the body.
http::Request request_in(const std::string& text) {
  const auto end = text.find("\n\n");
  const auto lines = base::split(text.substr(0, end), '\n');
  const auto words = base::split(lines.front(), ' ');
  http::Request request{.method = words.front(), .target = words.size() > 1 ? words[1] : "/"};
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto colon = lines[i].find(':');
    if (colon != std::string::npos)
      request.headers.emplace_back(lines[i].substr(0, colon), base::trim(lines[i].substr(colon + 1)));
  }
  if (end != std::string::npos) request.body = text.substr(end + 2);
  return request;
}

void fuzz_service_request(Bytes input) {
  auto& served = target();
  auto request = request_in(text_of(input));
  if (request.header("Authorization") == nullptr)
    request.headers.emplace_back("Authorization", "Bearer " + served.token);
  const auto answer = served.service->handle(request);
  expect(answer.status != 500, "the server made a mistake: " + answer.body);
  expect(answer.status < 503, "the server is in trouble: " + answer.body);
  // What was asked may be told back.
  expect(answer.body.find("treasure") == std::string::npos ||
             text_of(input).find("treasure") != std::string::npos,
         "a file outside of the page's folder");
  (void)served.service->body_limit(request);
  served.service->done({.request = request, .status = answer.status, .answer_bytes = 0, .seconds = 0});
}

void fuzz_wire(Bytes input) {
  static http::Server server({.threads = 2,
                              .limits = {.header_seconds = 1,
                                         .body_seconds = 1,
                                         .idle_seconds = 1,
                                         .requests_per_second = 1e9,
                                         .burst = 1e9}},
                             *target().service);
  try {
    const test::RawConnection connection(server.port());
    connection.send(text_of(input));
  } catch (const std::runtime_error&) {  // it hung up before all was sent
  }
  http::Client client("http://127.0.0.1:" + std::to_string(server.port()));
  expect(client.send({.method = "GET", .target = "/healthz"}).status == 200, "nobody is answered any more");
}

/// What keeps a scenario out is told as a document that a caller can read.
void fuzz_scenario(Bytes input) {
  static const auto model = target().service->model().now();
  try {
    const auto judged =
        repository::judge_inputs(text_of(input), "request", &model->schema(), &model->guard());
    expect(serve::Json::parse(judged.document).size() == model->schema().size(), "an input that is missing");
  } catch (const Error& error) {
    const auto problem = serve::problem_response(error);
    expect(problem.status == 400 || problem.status == 422, "not the caller's mistake: " + problem.body);
    expect(serve::Json::parse(problem.body)["detail"].is_string(), "no problem document: " + problem.body);
  }
}

/// As `elrom-serve --judge-fields` does.
void judge_upload(Bytes input) {
  static const test::SampleRun sample;
  try {
    const auto file = memory_file("upload.hdf", input);
    repository::judge_fields(file, sample.frame.mesh_digest);
    ingest::judge_physics_of(file, sample.mesh, {});
  } catch (const Error&) {
  }
}

std::string sample_upload() {
  const test::SampleRun sample;
  const auto file = memory_folder() / "seed.hdf";
  model::write_prediction(sample.frame, sample.prediction(), file);
  return test::read_bytes(file);
}

void fuzz_upload(Bytes input) {
  // HDF5 keeps what it needs for any file from the first that it reads: that is not an input's cost.
  static const std::string first = sample_upload();
  [[maybe_unused]] static const bool is_warm =
      (judge_upload({reinterpret_cast<const std::uint8_t*>(first.data()), first.size()}), true);
  judge_upload(input);
}

std::vector<std::string> request_seeds() {
  const std::string json = "Content-Type: application/json\nIdempotency-Key: k\n\n";
  return {
      "GET /scenarios?after=0&limit=10\nIf-None-Match: *\n\n",
      "GET /..%2fhidden.txt\n\n",
      "POST /scenarios\n" + json +
          R"({"name": "a", "load": 0.6, "inputs": {"flow_0 [kg/s]": 7, "flow_1 [kg/s]": 14, "flow_2 [kg/s]": 21, "flow_3 [t/h]": 100}})",
      "PUT /scenarios/1\nIf-Match: \"1\"\n" + json + R"({"name": "b", "inputs": {"flow_0 [kg/s]": -7}})",
      "POST /runs\n" + json + R"({"scenario": 1, "model": "elrom", "sources": [1]})",
      "POST /claims\n" + json + R"({"model": "elrom", "worker": "w", "lease_s": 60})",
      "POST /runs/1/outcome\n" + json +
          R"({"lease": "x", "state": "done", "result": {"version": "1", "document": {"a": [[[]]]}}, "ask": ["el3d"]})",
      "POST /predictions\n" + json +
          R"({"case": "a", "inputs": {"flow_0 [kg/s]": 7, "flow_1 [kg/s]": 14}, "fields": ["pressure"]})",
      "PUT /tokens/x\n" + json + R"({"role": "reader"})",
      "DELETE /tokens/y\n\n",
      "PUT /fields/" + std::string(64, 'a') + "\nContent-Type: application/x-hdf5\n\n\x89HDF",
      "GET /metrics\n\n"};
}

std::vector<std::string> wire_seeds() {
  return {
      "GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n",
      "POST /scenarios HTTP/1.1\r\nHost: x\r\nContent-Length: 2\r\nContent-Type: application/json\r\n\r\n{}",
      "POST /scenarios HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n",
      "POST /runs HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\nContent-Length: 5\r\n\r\nfffffffff\r\n",
      "GET /a HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: 9\r\n\r\n123456789GET / HTTP/1.0\r\n\r\n"};
}

}  // namespace

std::vector<FuzzTarget> service_targets() {
  return {
      {"http_target", fuzz_target}, {"json_body", fuzz_json_body}, {"service_request", fuzz_service_request},
      {"http_wire", fuzz_wire},     {"scenario", fuzz_scenario},   {"fields_upload", fuzz_upload}};
}

std::vector<std::string> service_seeds(const std::string& target) {
  if (target == "http_target")
    return {"/scenarios/1/results?after=3&limit=%31", "/a/%2e%2e/b", "/fields/%00"};
  if (target == "json_body")
    return {
        R"({"name": "a", "inputs": {"a": 1}, "load": 1e3, "sources": [1, 2], "fields": ["x"], "flag": true})",
        std::string(40, '[') + std::string(40, ']'), R"({"name": "\u0000", "name": "twice"})"};
  if (target == "scenario")
    return {
        R"({"case": "a", "load": 0.6, "inputs": {"flow_0 [kg/s]": 7, "flow_1 [kg/s]": 14, "flow_2 [kg/s]": 21, "flow_3 [t/h]": 100}})",
        R"({"inputs": {"flow_0 [K]": "\ud800", "flow_0": -1e999, "flow_1 [nothing]": [[]], "\u0000": null}})"};
  if (target == "service_request") return request_seeds();
  if (target == "http_wire") return wire_seeds();
  if (target == "fields_upload") return {sample_upload()};
  return {};
}

}  // namespace elrom::faults
