#pragma once
// A service that answers on a port of its own, with a small study and a token of each role.

#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "elrom/http/client.hpp"
#include "elrom/http/server.hpp"
#include "elrom/repository/rules.hpp"
#include "elrom/serve/service.hpp"
#include "elrom/study/versions.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::serve {

struct ServedOptions {
  bool with_model = true;
  http::Limits limits = {.requests_per_second = 1e9, .burst = 1e9};
  std::optional<repository::Role> anonymous = {};
  std::size_t most_json_bytes = std::size_t{1} << 16;
};

class Served {
 public:
  explicit Served(const ServedOptions& options = {}) {
    if (options.with_model) {
      test::sample_bundle({}).write(folder / "model.elrom");
      study::Versions(folder.path()).settle();
    }
    service = std::make_unique<Service>(ServiceOptions{
        .repository = {.folder = folder / "data"},
        .model = folder.path(),
        .page = folder / "page",
        .predict_program = ELROM_BIN_DIR "/elrom-predict",
        .report_program = folder / "report",
        .judge_upload = [](const auto& file, const auto& /*bundle*/) { repository::judge_fields(file, ""); },
        .anonymous = options.anonymous,
        .log =
            [this](const std::string& line) {
              const std::scoped_lock lock(log_mutex);
              log += line + "\n";
            },
        .most_json_bytes = options.most_json_bytes,
        .most_fields_bytes = std::size_t{1} << 19});
    service->model().look();
    service->repository().write([&](repository::Transaction& transaction) {
      for (const auto& role : repository::roles.entries) {
        const std::string name(role.name);
        tokens[name] = transaction.make_token(name, role.value);
      }
    });
    server = std::make_unique<http::Server>(http::ServerOptions{.limits = options.limits}, *service);
  }
  ~Served() { server->stop(5); }

  [[nodiscard]] std::string url() const { return "http://127.0.0.1:" + std::to_string(server->port()); }

  /// With a key of its own, as the admin.
  http::Response call(const std::string& method, const std::string& target, const std::string& body = "",
                      http::Headers headers = {}) {
    headers.emplace_back("Authorization", "Bearer " + tokens["admin"]);
    if (http::find_header(headers, "Idempotency-Key") == nullptr)
      headers.emplace_back("Idempotency-Key", "key" + std::to_string(++n_keys));
    if (!body.empty() && http::find_header(headers, "Content-Type") == nullptr)
      headers.emplace_back("Content-Type", "application/json");
    return send({.method = method, .target = target, .headers = std::move(headers), .body = body});
  }
  http::Response send(const http::Request& request) { return http::Client(url()).send(request); }

  /// Boundary conditions of the small model, somewhere inside.
  [[nodiscard]] static nlohmann::json inputs() {
    nlohmann::json inputs;
    const auto values = test::sample_case();
    for (std::size_t i = 0; i < values.size(); ++i)
      inputs["flow_" + std::to_string(i) + " [kg/s]"] = values[i];
    return inputs;
  }
  [[nodiscard]] static std::string scenario(const std::string& name) {
    return nlohmann::json{{"name", name}, {"boiler", "b"}, {"load", 0.64}, {"inputs", inputs()}}.dump();
  }

  test::TemporaryFolder folder;
  std::map<std::string, std::string> tokens;
  std::mutex log_mutex;
  std::string log;
  std::unique_ptr<Service> service;
  std::unique_ptr<http::Server> server;
  std::atomic<int> n_keys = 0;
};

inline nlohmann::json json_of(const http::Response& response) { return nlohmann::json::parse(response.body); }

}  // namespace elrom::serve
