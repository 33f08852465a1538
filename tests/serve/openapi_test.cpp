// The OpenAPI document as a caller reads it, and the server held to it: every path, every documented status.
#include <set>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "served.hpp"

namespace elrom::serve {
namespace {

using Json = nlohmann::json;

/// One operation of the document, and how to provoke each of its answers.
class Operation {
 public:
  Operation(Served& served, std::string path, std::string method, const Json& described)
      : served_(served), path_(std::move(path)), method_(std::move(method)), described_(described) {
    for (char& c : method_) c = static_cast<char>(std::toupper(c));
  }

  /// A request that is right in all that does not lead to `status`. Nothing: nobody knows how to get there.
  std::optional<http::Response> provoke(int status) {
    prepare();
    switch (status) {
      case 200:
        return other_of_two() ? again() : send();
      case 201:
        return send();
      case 204:
        return path_ == "/claims" ? claim_of_nothing() : send();
      case 304:
        return unchanged();
      case 400:
        return json_body() ? with_body("{\"") : with_target(path_now_ + "?limit=-1");
      case 401:
        return with_header("Authorization", "Bearer elrom.x.y");
      case 403:
        return with_header("Authorization", "Bearer " + served_.tokens["reader"]);
      case 404:
        return nothing_there();
      case 406:
        return with_header("Accept", "image/png");
      case 409:
        return conflict();
      case 412:
        return with_header("If-Match", "\"0\"");
      case 413:
        return with_body(std::string(std::size_t{1} << 20, ' '));
      case 415:
        return with_header("Content-Type", "text/plain");
      case 422:
        return with_body(json_body() ? content()["x-wrong-example"].dump() : "no HDF5");
      case 428:
        return without_conditions();
      default:
        return std::nullopt;
    }
  }

  [[nodiscard]] std::set<int> documented() const {
    std::set<int> statuses;
    for (const auto& [status, what] : described_["responses"].items())
      if (status != "default") statuses.insert(std::stoi(status));
    return statuses;
  }

 private:
  [[nodiscard]] bool json_body() const {
    return described_.contains("requestBody") &&
           described_["requestBody"]["content"].contains("application/json");
  }
  [[nodiscard]] bool hdf_body() const { return described_.contains("requestBody") && !json_body(); }
  [[nodiscard]] const Json& content() const {
    return described_["requestBody"]["content"]["application/json"];
  }
  /// 200 stands beside 201: what was there already.
  [[nodiscard]] bool other_of_two() const { return documented().contains(200) && documented().contains(201); }
  [[nodiscard]] bool asks_for(const std::string& header) const {
    if (!described_.contains("parameters")) return false;
    return std::ranges::any_of(described_["parameters"],
                               [&](const Json& one) { return one["name"] == header; });
  }

  /// Of this operation, and fit for a name.
  [[nodiscard]] std::string tag() const {
    auto text = path_ + method_;
    std::ranges::replace(text, '/', ' ');
    return text;
  }

  /// What the request is about is there, and the body speaks of it.
  void prepare() {
    const auto number = std::to_string(++n_);
    const auto scenario =
        json_of(served_.call("POST", "/scenarios", Served::scenario("of " + tag() + number)));
    const auto run = json_of(
        served_.call("POST", "/runs",
                     Json{{"scenario", scenario["id"]}, {"model", "m" + number + path_ + method_}}.dump()));
    const auto claimed = json_of(served_.call(
        "POST", "/claims", Json{{"model", run["model"]}, {"worker", "w"}, {"lease_s", 60}}.dump()));
    prepare_path(scenario, claimed);
    prepare_body(scenario, claimed, number);
    headers_ = {{"Authorization", "Bearer " + served_.tokens["admin"]}};
    if (asks_for("Idempotency-Key")) headers_.emplace_back("Idempotency-Key", path_ + method_ + number);
    if (asks_for("If-Match")) headers_.emplace_back("If-Match", "\"1\"");
    if (json_body()) headers_.emplace_back("Content-Type", "application/json");
    if (hdf_body()) headers_.emplace_back("Content-Type", "application/x-hdf5");
  }

  void prepare_path(const Json& scenario, const Json& run) {
    path_now_ = path_;
    const auto fill = [&](const std::string& mark, const std::string& text) {
      if (const auto at = path_now_.find(mark); at != std::string::npos)
        path_now_.replace(at, mark.size(), text);
    };
    if (path_.starts_with("/scenarios")) fill("{id}", scenario["id"].dump());
    if (path_.starts_with("/runs")) fill("{id}", run["id"].dump());
    if (path_.starts_with("/results")) fill("{id}", made_result(run));
    if (path_.starts_with("/quarantine")) fill("{id}", made_quarantine());
    if (path_.starts_with("/models")) fill("{id}", "1");
    if (path_ == "/models/{id}/report" || path_.starts_with("/reports"))
      test::write_bytes(report_file(), "<p>");
    if (path_.starts_with("/reports")) fill("/reports/{place}", made_report());
    if (path_ == "/mesh/cut") path_now_ += "?axis=x&at=5.3";
    if (path_.ends_with("}/cut")) path_now_ += "?axis=x&at=5.3";
    if (path_.starts_with("/tokens"))
      fill("{name}", method_ == "DELETE" ? made_token() : "new" + std::to_string(n_));
    if (path_.starts_with("/fields"))
      fill("{digest}", method_ == "GET" ? made_fields() : digest_of(fields_file()));
  }

  void prepare_body(const Json& scenario, const Json& run, const std::string& number) {
    body_ = hdf_body() ? fields_file() : "";
    if (!json_body()) return;
    auto body = content()["example"];
    if (body.contains("name")) body["name"] = "new " + tag() + number;
    if (body.contains("inputs")) body["inputs"] = Served::inputs();
    if (body.contains("scenario")) body["scenario"] = scenario["id"];
    if (path_ == "/claims") {
      const auto model = "fresh" + number;
      served_.call("POST", "/runs", Json{{"scenario", scenario["id"]}, {"model", model}}.dump());
      body["model"] = model;
    }
    if (body.contains("lease")) body["lease"] = run["lease"];
    body_ = body.dump();
  }

  [[nodiscard]] static std::string digest_of(const std::string& bytes) {
    return base::sha256(std::as_bytes(std::span(bytes)));
  }
  /// A new one each time: the case has another name.
  std::string fields_file() {
    if (n_ == file_of_) return file_;
    file_of_ = n_;
    const Json body{{"case", tag() + std::to_string(n_)}, {"inputs", Served::inputs()}};
    file_ = served_.call("POST", "/predictions", body.dump(), {{"Accept", "application/x-hdf5"}}).body;
    return file_;
  }
  std::string made_fields() {
    const auto bytes = fields_file();
    const auto digest = digest_of(bytes);
    served_.call("PUT", "/fields/" + digest, bytes, {{"Content-Type", "application/x-hdf5"}});
    return digest;
  }
  std::string made_result(const Json& run) {
    const Json outcome{{"lease", run["lease"]}, {"state", "done"}, {"result", {{"version", "1"}}}};
    return json_of(served_.call("POST", "/runs/" + run["id"].dump() + "/outcome", outcome.dump()))["result"]
        .dump();
  }
  std::string made_quarantine() {
    auto body = Json::parse(Served::scenario("wrong" + std::to_string(n_)));
    body["inputs"].begin().value() = -5;
    const auto place =
        json_of(served_.call("POST", "/scenarios", body.dump()))["quarantine"].get<std::string>();
    return place.substr(place.rfind('/') + 1);
  }
  /// Where the server keeps it.
  [[nodiscard]] std::filesystem::path report_file() const {
    const auto folder = served_.folder / "data/reports";
    std::filesystem::create_directories(folder);
    return folder / (model::BundleReader(served_.folder / "model.elrom").digest() + ".html");
  }
  std::string made_report() { return json_of(served_.call("POST", "/models/1/report"))["place"]; }
  std::string made_token() {
    const auto name = "token" + std::to_string(n_);
    served_.call("PUT", "/tokens/" + name, R"({"role": "reader"})");
    return name;
  }

  http::Response send() { return with_target(path_now_); }
  http::Response with_target(const std::string& target) {
    return served_.send({.method = method_, .target = target, .headers = headers_, .body = body_});
  }
  http::Response with_body(const std::string& body) {
    body_ = body;
    // The digest is of what is sent, so that it is judged.
    if (hdf_body()) path_now_ = "/fields/" + digest_of(body);
    return send();
  }
  http::Response with_header(const std::string& name, const std::string& value) {
    std::erase_if(headers_, [&](const auto& header) { return header.first == name; });
    headers_.emplace_back(name, value);
    return send();
  }
  http::Response again() {
    (void)send();
    return send();
  }
  http::Response unchanged() {
    const auto response = send();
    const auto* tag = response.header("ETag");
    return with_header("If-None-Match", tag == nullptr ? "none" : *tag);
  }
  http::Response nothing_there() {
    if (path_.find('{') == std::string::npos) return without_model();
    auto target = path_;
    const auto begin = target.find('{');
    target.replace(begin, target.find('}') - begin + 1,
                   path_.starts_with("/fields") ? std::string(64, '0') : "987654");
    if (hdf_body()) target = "/fields/nothing";
    return with_target(target);
  }
  http::Response without_model() {
    Served bare({.with_model = false});
    std::erase_if(headers_, [](const auto& header) { return header.first == "Authorization"; });
    headers_.emplace_back("Authorization", "Bearer " + bare.tokens["admin"]);
    return bare.send({.method = method_, .target = path_now_, .headers = headers_, .body = body_});
  }
  http::Response claim_of_nothing() {
    auto body = content()["example"];
    body["model"] = "nobody's";
    return with_body(body.dump());
  }
  /// The same key for something else; where there is none, what cannot be twice.
  http::Response conflict() {
    if (path_ == "/models/current") {
      const base::FileLock at_work(served_.folder / ".lock");
      return send();
    }
    if (path_.ends_with("/report")) {
      std::filesystem::remove(report_file());
      const base::FileLock being_made(report_file().parent_path() / ".lock");
      return send();
    }
    (void)send();
    if (!asks_for("Idempotency-Key")) {
      if (path_.ends_with("/lease")) return with_body(R"({"lease": "wrong", "lease_s": 60})");
      return send();
    }
    auto body = Json::parse(body_);
    for (const char* key : {"note", "worker", "reason"})
      if (body.contains(key)) body[key] = "another";
    if (path_ == "/runs") body["model"] = "another";
    return with_body(body.dump());
  }
  http::Response without_conditions() {
    std::erase_if(headers_, [](const auto& header) {
      return header.first == "Idempotency-Key" || header.first == "If-Match";
    });
    return send();
  }

  Served& served_;
  std::string path_, method_, path_now_, body_, file_;
  Json described_;
  http::Headers headers_;
  int n_ = 0, file_of_ = -1;
};

void expect_problem(const http::Response& response, const std::string& what) {
  ASSERT_NE(response.header("Content-Type"), nullptr) << what;
  EXPECT_EQ(*response.header("Content-Type"), "application/problem+json") << what;
  const auto problem = json_of(response);
  for (const char* key : {"type", "title", "detail", "what"})
    EXPECT_TRUE(problem[key].is_string()) << what << key;
  EXPECT_EQ(problem["status"], response.status) << what;
}

TEST(OpenApi, EveryDocumentedAnswerOfEveryPathIsGiven) {
  Served served;
  const auto document = json_of(served.send({.method = "GET", .target = "/openapi.json"}));
  int n_answers = 0;

  for (const auto& [path, methods] : document["paths"].items())
    for (const auto& [method, described] : methods.items()) {
      Operation operation(served, path, method, described);
      for (const int status : operation.documented()) {
        const auto what = method + " " + path + " -> " + std::to_string(status);
        const auto response = operation.provoke(status);
        ASSERT_TRUE(response) << what << ": no way to provoke it";
        EXPECT_EQ(response->status, status) << what << ": " << response->body.substr(0, 500);
        if (status >= 400) expect_problem(*response, what);
        ++n_answers;
      }
    }

  EXPECT_GT(n_answers, 100);
}

TEST(OpenApi, TheDocumentSaysWhatValidatorsAskFor) {
  Served served;
  const auto document = json_of(served.send({.method = "GET", .target = "/openapi.json"}));

  EXPECT_EQ(document["openapi"], "3.1.0");
  EXPECT_TRUE(document["info"]["title"].is_string());
  EXPECT_TRUE(document["info"]["version"].is_string());
  for (const auto& [path, methods] : document["paths"].items())
    for (const auto& [method, operation] : methods.items()) {
      std::size_t n_marks = 0, n_path_parameters = 0;
      for (const char c : path) n_marks += c == '{';
      if (operation.contains("parameters"))
        for (const auto& one : operation["parameters"]) n_path_parameters += one["in"] == "path";
      EXPECT_EQ(n_marks, n_path_parameters) << path;
      EXPECT_TRUE(operation["responses"].contains("default")) << path;
    }
}

TEST(OpenApi, WhatTheTableDoesNotKnowIsNowhere) {
  Served served;

  EXPECT_EQ(served.call("GET", "/nothing").status, 404);
  EXPECT_EQ(served.call("GET", "/scenarios/1/2/3").status, 404);
  const auto wrong = served.call("DELETE", "/scenarios");
  EXPECT_EQ(wrong.status, 405);
  EXPECT_EQ(*wrong.header("Allow"), "GET, POST");
  EXPECT_EQ(served.call("GET", "/scenarios/..%2f..").status, 400);
}

}  // namespace
}  // namespace elrom::serve
