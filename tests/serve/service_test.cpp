#include "elrom/serve/service.hpp"

#include <bit>
#include <cstring>
#include <thread>

#include "elrom/base/digest.hpp"
#include "elrom/base/random.hpp"
#include "elrom/model/prediction_file.hpp"
#include "served.hpp"

namespace elrom::serve {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Service, AScenarioIsKeptMarkedAndFoundAgain) {
  Served served;

  const auto made = served.call("POST", "/scenarios", Served::scenario("a"));
  const auto read = served.call("GET", *made.header("Location"));

  EXPECT_EQ(made.status, 201);
  EXPECT_EQ(*made.header("ETag"), "\"1\"");
  EXPECT_EQ(json_of(read), json_of(made));
  EXPECT_EQ(json_of(read)["verdict"], "inside");
  EXPECT_EQ(json_of(read)["by"], "admin");
  EXPECT_EQ(json_of(read)["load"], 0.64);
}

TEST(Service, WhatIsOutsideTheTrainedRangeGoesOnMarked) {
  Served served;
  auto body = Json::parse(Served::scenario("far"));
  body["inputs"].begin().value() = 500;

  const auto made = served.call("POST", "/scenarios", body.dump());

  EXPECT_EQ(made.status, 201);
  EXPECT_EQ(json_of(made)["verdict"], "outside");
  EXPECT_THAT(json_of(made)["reason"].get<std::string>(), HasSubstr("flow_0 1800 t/h"));
}

TEST(Service, WhatNoFurnaceCanHaveGoesIntoQuarantineAndToNoModel) {
  Served served;
  auto body = Json::parse(Served::scenario("wrong"));
  body["inputs"].begin().value() = -5;

  const auto refused = served.call("POST", "/scenarios", body.dump(), {{"Idempotency-Key", "k"}});
  const auto again = served.call("POST", "/scenarios", body.dump(), {{"Idempotency-Key", "k"}});

  EXPECT_EQ(refused.status, 422);
  EXPECT_THAT(json_of(refused)["what"].get<std::string>(), HasSubstr("impossible"));
  EXPECT_THAT(json_of(refused)["found"].get<std::string>(), HasSubstr("-18 t/h"));
  const auto kept = json_of(served.call("GET", json_of(refused)["quarantine"]));
  EXPECT_EQ(kept["kind"], "scenario");
  EXPECT_THAT(kept["reason"].get<std::string>(), HasSubstr("impossible"));
  EXPECT_EQ(Json::parse(kept["document"].get<std::string>()), body);
  EXPECT_EQ(json_of(again), json_of(refused));
  EXPECT_EQ(json_of(served.call("GET", "/quarantine"))["items"].size(), 1U);
  EXPECT_TRUE(json_of(served.call("GET", "/scenarios"))["items"].empty());
}

TEST(Service, ARepeatedWriteIsDoneOnce) {
  Served served;
  const http::Headers key{{"Idempotency-Key", "k"}};

  const auto first = served.call("POST", "/scenarios", Served::scenario("a"), key);
  const auto second = served.call("POST", "/scenarios", Served::scenario("a"), key);
  const auto other = served.call("POST", "/scenarios", Served::scenario("b"), key);

  EXPECT_EQ(second.status, 201);
  EXPECT_EQ(second.body, first.body);
  EXPECT_EQ(*second.header("Idempotent-Replayed"), "true");
  EXPECT_EQ(other.status, 409);
  EXPECT_EQ(json_of(served.call("GET", "/scenarios"))["items"].size(), 1U);
}

TEST(Service, TwoWhoReadTheSameCannotBothChangeIt) {
  Served served;
  served.call("POST", "/scenarios", Served::scenario("a"));

  const auto first = served.call("PUT", "/scenarios/1", Served::scenario("b"), {{"If-Match", "\"1\""}});
  const auto second = served.call("PUT", "/scenarios/1", Served::scenario("c"), {{"If-Match", "\"1\""}});

  EXPECT_EQ(first.status, 200);
  EXPECT_EQ(*first.header("ETag"), "\"2\"");
  EXPECT_EQ(second.status, 412);
  EXPECT_EQ(json_of(served.call("GET", "/scenarios/1"))["name"], "b");
}

TEST(Service, ARunGoesFromWaitingToItsResult) {
  Served served;
  served.call("POST", "/scenarios", Served::scenario("a"));
  served.call("POST", "/runs", R"({"scenario": 1, "model": "elrom"})");

  const auto claimed =
      json_of(served.call("POST", "/claims", R"({"model": "elrom", "worker": "w", "lease_s": 60})"));
  const auto seen = json_of(served.call("GET", "/runs/1"));
  const Json outcome{{"lease", claimed["lease"]},
                     {"state", "done"},
                     {"result", {{"version", "v"}, {"verdict", "inside"}, {"document", {{"q", 1.5}}}}}};
  const auto done = json_of(served.call("POST", "/runs/1/outcome", outcome.dump()));
  const auto result = json_of(served.call("GET", "/results/" + done["result"].dump()));

  EXPECT_EQ(claimed["inputs"].size(), Served::inputs().size());
  EXPECT_EQ(seen["state"], "running");
  EXPECT_FALSE(seen.contains("lease")) << "a lease is a secret";
  EXPECT_EQ(done["state"], "done");
  EXPECT_EQ(result["document"], (Json{{"q", 1.5}}));
  EXPECT_EQ(json_of(served.call("GET", "/runs?state=done"))["items"].size(), 1U);
  EXPECT_EQ(json_of(served.call("GET", "/scenarios/1/results"))["items"][0], result);
}

TEST(Service, AskingInVainLeavesNoTrace) {
  Served served;
  const std::string claim = R"({"model": "elrom", "worker": "w", "lease_s": 60})";
  const http::Headers key{{"Idempotency-Key", "k"}};

  EXPECT_EQ(served.call("POST", "/claims", claim, key).status, 204);
  served.call("POST", "/scenarios", Served::scenario("a"));
  served.call("POST", "/runs", R"({"scenario": 1, "model": "elrom"})");

  EXPECT_EQ(served.call("POST", "/claims", claim, key).status, 201);
}

TEST(Service, AListIsReadInParts) {
  Served served;
  for (const char* name : {"a", "b", "c"}) served.call("POST", "/scenarios", Served::scenario(name));

  const auto first = json_of(served.call("GET", "/scenarios?limit=2"));
  const auto second = json_of(served.call("GET", "/scenarios?limit=2&after=" + first["next"].dump()));

  EXPECT_EQ(first["items"].size(), 2U);
  EXPECT_EQ(second["items"].size(), 1U);
  EXPECT_TRUE(second["next"].is_null());
}

/// The same numbers as the predictor's own.
std::vector<float> expected_values(const Served& served, const std::string& field) {
  const model::Predictor predictor(served.folder / "model.elrom", {.fields = {field}});
  std::vector<float> values(predictor.size());
  model::Predictor::Scratch scratch;
  predictor.predict(test::sample_case(), values, {}, scratch);
  return values;
}

TEST(Service, APredictionHasTheSameBitsInEveryForm) {
  Served served;
  const auto body = Json{{"inputs", Served::inputs()}, {"fields", {"pressure", "solid_velocity_z"}}}.dump();
  const auto ask = [&](const char* form) {
    return served.call("POST", "/predictions", body, {{"Accept", form}});
  };
  const auto expected = expected_values(served, "pressure");

  const auto json = json_of(ask("application/json"));
  const auto binary = ask("application/octet-stream").body;
  test::write_bytes(served.folder / "a.hdf", ask("application/x-hdf5").body);
  const auto hdf = model::read_prediction(served.folder / "a.hdf");

  EXPECT_EQ(json["verdict"], "inside");
  EXPECT_EQ(json["level"], 0.9);
  EXPECT_EQ(json["fields"]["pressure"]["unit"], "Pa");
  EXPECT_EQ(json["fields"]["pressure"]["values"].get<std::vector<float>>(), expected);
  EXPECT_EQ(hdf.field("pressure").values, expected);
  EXPECT_EQ(hdf.field("pressure").half_width,
            json["fields"]["pressure"]["half_width"].get<std::vector<float>>());
  std::uint64_t length = 0;
  std::memcpy(&length, binary.data(), sizeof length);
  const auto head = Json::parse(binary.substr(sizeof length, length));
  const std::size_t begin = head["fields"]["pressure"]["values"][0],
                    end = head["fields"]["pressure"]["values"][1];
  std::vector<float> values(end - begin);
  std::memcpy(values.data(), binary.data() + sizeof length + length + begin * sizeof(float),
              values.size() * sizeof(float));
  EXPECT_EQ((sizeof length + length) % 8, 0U);
  EXPECT_EQ(values, expected);
  EXPECT_EQ(binary.size(), sizeof length + length + 4 * values.size() * sizeof(float));
}

TEST(Service, PartsOfAPredictionHaveTheBitsOfAllCells) {
  Served served;
  const Json whole{{"inputs", Served::inputs()}, {"fields", {"pressure"}}};
  auto parts = whole;
  parts["cuts"] = {{{"axis", "x"}, {"at", 5.0}}, {{"axis", "z"}, {"at", 20.0}}};
  parts["profile"] = true;
  const auto polygons = served.call("GET", "/mesh/cut?axis=x&at=5").body;
  std::uint64_t length = 0;
  std::memcpy(&length, polygons.data(), sizeof length);
  const std::size_t n = Json::parse(polygons.substr(sizeof length, length))["cells"][1];
  std::vector<std::int32_t> cells(n);
  std::memcpy(cells.data(), polygons.data() + sizeof length + length, n * sizeof cells[0]);

  const auto all = json_of(served.call("POST", "/predictions", whole.dump()));
  const auto some = json_of(served.call("POST", "/predictions", parts.dump()));

  ASSERT_EQ(some["parts"].size(), 3U);
  EXPECT_EQ(some["parts"][0]["places"], Json({0, 15}));  // 3 rows of columns in 5 planes
  EXPECT_EQ(some["parts"][1]["places"], Json({15, 27}));
  EXPECT_EQ(some["parts"][2], Json({{"profile", true}, {"places", {27, 32}}}));
  for (const char* kind : {"values", "half_width"})
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_EQ(some["fields"]["pressure"][kind][i],
                all["fields"]["pressure"][kind][static_cast<std::size_t>(cells[i])]);
}

TEST(Service, KeptFieldsAreShownWhereACutGoesThroughThem) {
  Served served;
  auto request = Json{{"inputs", Served::inputs()}, {"fields", {"pressure"}}};
  const auto file =
      served.call("POST", "/predictions", request.dump(), {{"Accept", "application/x-hdf5"}}).body;
  const auto place = "/fields/" + base::sha256(std::as_bytes(std::span(file)));
  served.call("PUT", place, file, {{"Content-Type", "application/x-hdf5"}});
  request["cuts"] = {{{"axis", "x"}, {"at", 5.0}}};
  const auto expected = json_of(served.call("POST", "/predictions", request.dump()));

  const auto cut = served.call("GET", place + "/cut?axis=x&at=5").body;
  std::uint64_t length = 0;
  std::memcpy(&length, cut.data(), sizeof length);
  const auto head = Json::parse(cut.substr(sizeof length, length));
  ASSERT_EQ(head["fields"], Json({{"pressure", {{"unit", "Pa"}, {"values", {0, 15}}}}}));
  std::vector<float> values(15);
  std::memcpy(values.data(), cut.data() + sizeof length + length, 15 * sizeof values[0]);

  EXPECT_EQ(values, expected["fields"]["pressure"]["values"].get<std::vector<float>>());
  EXPECT_EQ(served.call("GET", place + "/cut?axis=x&at=50").status, 400);

  test::sample_bundle({.n_planes = 6}).write(served.folder / "models/2.elrom");
  served.call("PUT", "/models/current", R"({"number": 2})");
  const auto elsewhere = served.call("GET", place + "/cut?axis=x&at=5").body;
  EXPECT_NE(elsewhere.find("\"fields\":null"), std::string::npos);
}

TEST(Service, ACutThatMissesTheFurnaceIsToldWhereItLies) {
  Served served;
  auto request = Json{{"inputs", Served::inputs()}, {"cuts", {{{"axis", "z"}, {"at", 47.5}}}}};

  const auto answer = served.call("POST", "/predictions", request.dump());

  EXPECT_EQ(answer.status, 422);
  EXPECT_EQ(json_of(answer)["expected"], "0 to 47 m");
  EXPECT_EQ(served.call("GET", "/mesh/cut?axis=w&at=1").status, 400);
}

TEST(Service, FilesAreThoseOfElromPredict) {
  Served served;
  const auto ask = [&](const char* format) {
    return served.call("POST", "/predictions/file",
                       Json{{"inputs", Served::inputs()}, {"format", format}, {"intervals", false}}.dump());
  };
  const auto expected = expected_values(served, "pressure");

  test::write_bytes(served.folder / "a.hdf", ask("hdf").body);
  const auto csv = ask("csv");

  EXPECT_EQ(model::read_prediction(served.folder / "a.hdf").field("pressure").values, expected);
  EXPECT_THAT(csv.body, ::testing::StartsWith("plane,column,x [m],y [m],z [m],solid_velocity_x [m/s]"));
  EXPECT_EQ(*csv.header("Content-Disposition"), "attachment; filename=\"prediction.csv\"");
  EXPECT_EQ(ask("openfoam").status, 422);  // no case to start was given
  EXPECT_TRUE(std::filesystem::is_empty(served.folder / "data/outgoing"));
}

TEST(Service, TheTrainingCasesTellWhatGoesWithALoad) {
  Served served;

  const auto cases = json_of(served.call("GET", "/model/cases"));

  EXPECT_EQ(cases["inputs"][0], "flow_0 [kg/s]");
  ASSERT_EQ(cases["items"].size(), 12U);
  EXPECT_EQ(cases["items"][0]["load"], 0.4);
  EXPECT_EQ(cases["items"][0]["values"].size(), 4U);
}

TEST(Service, AVersionIsPromotedByAnAdminAndAnswersAtOnce) {
  Served served;
  const auto first = json_of(served.call("GET", "/model"))["digest"];
  test::sample_bundle({}, 2).write(served.folder / "models/2.elrom");

  const auto versions = json_of(served.call("GET", "/models"))["items"];
  const auto promoted = served.call("PUT", "/models/current", R"({"number": 2})");

  EXPECT_EQ(versions[0]["answers"], true);
  EXPECT_EQ(versions[1]["answers"], false);
  EXPECT_EQ(promoted.status, 200);
  EXPECT_EQ(json_of(promoted)["answers"], true);
  EXPECT_NE(json_of(served.call("GET", "/model"))["digest"], first);
  EXPECT_EQ(json_of(served.call("GET", "/models/1"))["answers"], false);
}

TEST(Service, ACallerIsToldWhatHeMayDo) {
  Served served;

  const auto caller = json_of(served.call("GET", "/caller"));

  EXPECT_EQ(caller, Json({{"name", "admin"}, {"role", "admin"}}));
}

TEST(Service, RunsAreListedByScenario) {
  Served served;
  for (const char* name : {"a", "b"}) served.call("POST", "/scenarios", Served::scenario(name));
  for (const char* run : {R"({"scenario": 1, "model": "m"})", R"({"scenario": 2, "model": "m"})"})
    served.call("POST", "/runs", run);

  const auto runs = json_of(served.call("GET", "/runs?scenario=2"))["items"];

  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0]["scenario"], 2);
}

TEST(Service, APredictionSaysWhatTheGuardThinks) {
  Served served;
  auto inputs = Served::inputs();
  inputs.begin().value() = 500;

  const auto answer =
      json_of(served.call("POST", "/predictions", Json{{"inputs", inputs}, {"fields", {"pressure"}}}.dump()));

  EXPECT_EQ(answer["verdict"], "outside");
  EXPECT_EQ(answer["nearest"].size(), 3U);
  EXPECT_FALSE(answer["out_of_range"].empty());
}

TEST(Service, AnUnknownFieldIsAnsweredWithTheNearest) {
  Served served;

  const auto answer =
      served.call("POST", "/predictions", Json{{"inputs", Served::inputs()}, {"fields", {"presure"}}}.dump());

  EXPECT_EQ(answer.status, 422);
  EXPECT_THAT(json_of(answer)["advice"].get<std::string>(), HasSubstr("pressure"));
}

TEST(Service, TheModelTellsItsInputsWithRanges) {
  Served served;

  const auto model = json_of(served.call("GET", "/model"));

  EXPECT_EQ(model["inputs"].size(), 4U);
  EXPECT_EQ(model["fields"].size(), 9U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(model["inputs"][i]["low"], test::sample_case()[i]);
    EXPECT_GT(model["inputs"][i]["high"], test::sample_case()[i]);
  }
  EXPECT_EQ(served.call("GET", "/mesh").body.size(), 5U * 12 * 3 * sizeof(float));
}

TEST(Service, ANewModelIsTakenUpAndWhoAsksKeepsTheOld) {
  Served served;
  const auto old = served.service->model().now();
  const auto before = json_of(served.call("GET", "/model"))["digest"];
  test::sample_bundle({}, 2).write(served.folder / "model.elrom");

  EXPECT_TRUE(served.service->model().look());

  EXPECT_NE(json_of(served.call("GET", "/model"))["digest"], before);
  EXPECT_EQ(old->bundle().digest(), before);
  EXPECT_FALSE(served.service->model().look());
}

http::Response upload(Served& served, const std::string& bytes) {
  return served.call("PUT", "/fields/" + base::sha256(std::as_bytes(std::span(bytes))), bytes,
                     {{"Content-Type", "application/x-hdf5"}});
}

TEST(Service, FieldsGoUpAndComeDownUnchanged) {
  Served served;
  const auto file = served
                        .call("POST", "/predictions", Json{{"inputs", Served::inputs()}}.dump(),
                              {{"Accept", "application/x-hdf5"}})
                        .body;

  const auto first = upload(served, file), second = upload(served, file);
  const auto down = served.call("GET", *first.header("Location"));

  EXPECT_EQ(first.status, 201);
  EXPECT_EQ(second.status, 200);
  EXPECT_EQ(down.body, file);
  EXPECT_TRUE(std::filesystem::is_empty(served.folder / "data/incoming"));
}

TEST(Service, ACorruptFieldIsPutAside) {
  Served served;
  auto file = served
                  .call("POST", "/predictions", Json{{"inputs", Served::inputs()}}.dump(),
                        {{"Accept", "application/x-hdf5"}})
                  .body;
  file.resize(file.size() / 2);

  const auto refused = upload(served, file);

  EXPECT_EQ(refused.status, 422);
  const auto kept = json_of(served.call("GET", json_of(refused)["quarantine"]));
  EXPECT_EQ(kept["kind"], "fields");
  const auto document = Json::parse(kept["document"].get<std::string>());
  EXPECT_EQ(test::read_bytes(served.folder / "data" / document["file"].get<std::string>()), file);
}

TEST(Service, AnUploadThatWasCutOnItsWayIsToldApart) {
  Served served;

  const auto refused =
      served.call("PUT", "/fields/" + std::string(64, 'a'), "cut", {{"Content-Type", "application/x-hdf5"}});

  EXPECT_EQ(refused.status, 422);
  EXPECT_THAT(json_of(refused)["what"].get<std::string>(), HasSubstr("not what its digest says"));
  EXPECT_TRUE(json_of(served.call("GET", "/quarantine"))["items"].empty());
}

TEST(Service, EachRoleMayDoItsPart) {
  Served served;
  const auto status = [&](const std::string& role, const std::string& method, const std::string& target) {
    return served
        .send({.method = method,
               .target = target,
               .headers = {{"Authorization", "Bearer " + served.tokens[role]},
                           {"Content-Type", "application/json"},
                           {"Idempotency-Key", role}},
               .body = method == "GET" ? "" : Served::scenario(role)})
        .status;
  };

  EXPECT_EQ(status("reader", "GET", "/scenarios"), 200);
  EXPECT_EQ(status("reader", "POST", "/scenarios"), 403);
  EXPECT_EQ(status("model", "POST", "/scenarios"), 201);
  EXPECT_EQ(status("model", "GET", "/tokens"), 403);
  EXPECT_EQ(status("admin", "GET", "/tokens"), 200);
  EXPECT_EQ(served.send({.method = "GET", .target = "/scenarios"}).status, 401);
  EXPECT_EQ(served.send({.method = "GET", .target = "/healthz"}).status, 200);
}

TEST(Service, WhoBringsNoTokenHasTheRoleOfTheAnonymous) {
  Served served({.anonymous = repository::Role::reader});

  EXPECT_EQ(served.send({.method = "GET", .target = "/scenarios"}).status, 200);
  EXPECT_EQ(served.send({.method = "GET", .target = "/tokens"}).status, 403);
}

TEST(Service, ATokenWorksUntilItIsTakenBack) {
  Served served;
  const auto secret =
      json_of(served.call("PUT", "/tokens/new", R"({"role": "reader"})"))["token"].get<std::string>();
  const auto status = [&] {
    return served
        .send({.method = "GET", .target = "/runs", .headers = {{"Authorization", "Bearer " + secret}}})
        .status;
  };

  EXPECT_EQ(status(), 200);
  served.call("DELETE", "/tokens/new");
  EXPECT_EQ(status(), 401);
}

TEST(Service, MetricsCountRequestsAndWhatIsThere) {
  Served served;
  served.call("POST", "/scenarios", Served::scenario("a"));
  served.call("GET", "/scenarios/1");
  served.call("GET", "/scenarios/2");

  const auto text = served.call("GET", "/metrics").body;

  EXPECT_THAT(text, HasSubstr("elrom_requests_total{route=\"POST /scenarios\",status=\"201\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("elrom_requests_total{route=\"GET /scenarios/{id}\",status=\"404\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("elrom_request_seconds_count{route=\"GET /scenarios/{id}\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("elrom_scenarios 1\n"));
  EXPECT_THAT(text, HasSubstr("elrom_model_open 1\n"));
}

TEST(Service, EveryRequestIsALineOfJsonInTheLogWithoutSecrets) {
  Served served;
  served.call("GET", "/scenarios/1?x=%22");
  served.server->stop(5);

  const auto line = Json::parse(served.log.substr(0, served.log.find('\n')));

  EXPECT_EQ(line["method"], "GET");
  EXPECT_EQ(line["target"], "/scenarios/1?x=%22");
  EXPECT_EQ(line["status"], 404);
  EXPECT_GT(line["seconds"], 0);
  EXPECT_THAT(served.log, Not(HasSubstr(served.tokens["admin"])));
}

/// Sound bodies with something wrong in them, or nonsense.
std::string damaged_body(base::Random& random) {
  static const std::vector<std::string> sound{
      Served::scenario("a"), R"({"scenario": 1, "model": "m", "sources": [1]})",
      R"({"model": "m", "worker": "w", "lease_s": 60})",
      R"({"lease": "x", "state": "done", "result": {"version": "1"}})", R"({"role": "reader"})"};
  static const std::vector<std::string> pieces{"{",
                                               "}",
                                               "[",
                                               "]",
                                               "\"",
                                               ":",
                                               ",",
                                               "-",
                                               "1e999",
                                               "null",
                                               "true",
                                               "\\u0000",
                                               "\\ud800",
                                               "\xFF",
                                               "9223372036854775808",
                                               "0.1",
                                               "'; DROP TABLE runs; --",
                                               "{\"a\":",
                                               "[[[["};
  auto text = sound[random.below(sound.size())];
  for (auto n = 1 + random.below(3); n > 0; --n) {
    const auto at = random.below(text.size());
    const auto& piece = pieces[random.below(pieces.size())];
    switch (random.below(4)) {
      case 0:
        text.erase(at, 1 + random.below(5));
        break;
      case 1:
        text.insert(at, piece);
        break;
      case 2:
        text.replace(at, std::min<std::size_t>(text.size() - at, 3), piece);
        break;
      default:
        text.insert(at, std::string(random.below(200), '['));
        break;
    }
    if (text.empty()) text = "{";
  }
  return text;
}

TEST(Service, DamagedBodiesAndPathsAreNeverAFaultOfOurs) {
  Served served;
  served.call("POST", "/scenarios", Served::scenario("sound"));
  base::Random random(base::Seed(5).derive("bodies"));
  http::Client client(served.url());
  const std::vector<std::pair<std::string, std::string>> places{{"POST", "/scenarios"},
                                                                {"PUT", "/scenarios/1"},
                                                                {"POST", "/runs"},
                                                                {"POST", "/claims"},
                                                                {"PUT", "/runs/1/lease"},
                                                                {"POST", "/runs/1/outcome"},
                                                                {"POST", "/predictions"},
                                                                {"PUT", "/tokens/x"},
                                                                {"GET", "/scenarios/%FF%FE"},
                                                                {"GET", "/runs/-1"},
                                                                {"GET", "/runs/99999999999999999999"},
                                                                {"GET", "/fields/%27%3B--"},
                                                                {"GET", "/runs?state=%FF"},
                                                                {"GET", "/runs?model=%27%20OR%201=1"}};

  for (int i = 0; i < 1500; ++i) {
    const auto& [method, target] = places[random.below(places.size())];
    const auto body = method == "GET" ? std::string() : damaged_body(random);
    const auto response = client.send({.method = method,
                                       .target = target,
                                       .headers = {{"Authorization", "Bearer " + served.tokens["admin"]},
                                                   {"Content-Type", "application/json"},
                                                   {"Idempotency-Key", std::to_string(i)},
                                                   {"If-Match", random.below(2) == 0 ? "\"1\"" : "\"x\xFF"}},
                                       .body = body});
    ASSERT_LT(response.status, 500) << method << " " << target << "\n" << body << "\n" << response.body;
  }

  EXPECT_EQ(served.call("GET", "/healthz").status, 200);
}

TEST(Service, DeepJsonIsRefusedBeforeItHurts) {
  Served served({.most_json_bytes = std::size_t{1} << 20});

  const auto response = served.call("POST", "/scenarios", std::string(1000000, '['));

  EXPECT_EQ(response.status, 400);
  EXPECT_THAT(response.body, HasSubstr("nested too deeply"));
}

TEST(Service, ManyClientsReadAndWriteAtOnce) {
  Served served;
  std::atomic<int> n_wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 10; ++i) {
        const auto name = std::to_string(t) + "-" + std::to_string(i);
        const auto made = served.call("POST", "/scenarios", Served::scenario(name));
        n_wrong += made.status != 201;
        const auto body = Json{{"inputs", Served::inputs()}, {"fields", {"pressure"}}}.dump();
        n_wrong += served.call("POST", "/predictions", body).status != 200;
        n_wrong +=
            made.status == 201 && json_of(served.call("GET", *made.header("Location")))["name"] != name;
      }
    });
  for (auto& thread : threads) thread.join();

  EXPECT_EQ(n_wrong, 0);
  EXPECT_EQ(json_of(served.call("GET", "/scenarios?limit=1000"))["items"].size(), 80U);
}

}  // namespace
}  // namespace elrom::serve
