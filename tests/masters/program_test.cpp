// elrom-master as a machine meets it: beside a served repository, with a program that is not ours.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/http/client.hpp"
#include "elrom/ingest/cases_table.hpp"
#include "support/outcome.hpp"
#include "support/serving.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::masters {
namespace {

using Json = nlohmann::json;
using test::outcome_of;
using ::testing::HasSubstr;

const std::string server = ELROM_BIN_DIR "/elrom-serve", master = ELROM_BIN_DIR "/elrom-master";

/// A repository with the operating point of a shipped case, and a solver that has its table.
struct Works {
  test::TemporaryFolder folder;
  std::string data = (folder / "data").string();
  std::filesystem::path token =
      folder.write("token", outcome_of(server + " --data " + data + " --make-token me=admin").text);
  test::Serving serving{server, {"--data", data, "--quiet"}};

  Works() {
    folder.write("solver/templates/run.in",
                 "zcat " ELROM_SOURCE_DIR
                 "/data/formats/fluent_ascii/train_000_comma.txt.gz > {{case}}.txt\n");
    describe("");
    field::write_mesh(folder / "mesh.h5", field::make_furnace_mesh({}, 10, 21, 33));
    const auto table = ingest::read_cases_table(ELROM_SOURCE_DIR "/data/cases/cases.csv");
    Json inputs;
    for (std::size_t i = 0; i < table.schema.size(); ++i)
      inputs[table.schema[i].name + " [" + table.schema[i].unit + "]"] = table.cases[0].values[i];
    call("POST", "/scenarios", {{"name", "a"}, {"load", 0.46}, {"inputs", inputs}});
    call("POST", "/runs", {{"scenario", 1}, {"model", "el3d"}});
  }
  void describe(const std::string& more) const {
    folder.write(
        "solver/program.toml",
        "name = \"solver\"\ntemplates = \"templates\"\ncommand = \"sh run\"\ncase = \"{{case}}.txt\"\n" +
            more);
  }
  Json call(const std::string& method, const std::string& target, const Json& body = {}) const {
    static int n_keys = 0;
    const auto answer =
        http::Client(serving.url())
            .send({.method = method,
                   .target = target,
                   .headers = {{"Authorization", "Bearer " + base::trim(base::read_text(token))},
                               {"Content-Type", "application/json"},
                               {"Idempotency-Key", "k" + std::to_string(++n_keys)}},
                   .body = body.is_null() ? "" : body.dump()});
    return Json::parse(answer.body);
  }
  [[nodiscard]] test::Outcome work(const std::string& model, const std::string& options) const {
    return outcome_of(master + " " + model + " --repository " + serving.url() + " --token-file " +
                      token.string() + " --work " + (folder / "work").string() + " --once " + options +
                      " 2>&1");
  }
  [[nodiscard]] test::Outcome simulate(const std::string& options = "") const {
    return work("el3d", "--program " + (folder / "solver/program.toml").string() + " --mesh " +
                            (folder / "mesh.h5").string() +
                            " --furnace " ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml " + options);
  }
};

TEST(ElromMaster, SimulatesAndHandsTheCaseOn) {
  const Works works;

  const auto ended = works.simulate("--then elrom-build");

  EXPECT_EQ(ended.status, 0) << ended.text;
  EXPECT_THAT(ended.text, HasSubstr("1 run worked off"));
  const auto result = works.call("GET", "/results/1");
  EXPECT_EQ(result["version"], "solver");
  EXPECT_TRUE(result["fields"].is_string());
  const auto next = works.call("GET", "/runs/" + result["followed_by"][0].dump());
  EXPECT_EQ(next["model"], "elrom-build");
  EXPECT_EQ(next["sources"], Json::array({1}));
  EXPECT_EQ(works.simulate().status, 8) << "nothing waits";
}

TEST(ElromMaster, ARunWaitsForAProgramThatIsNotInstalled) {
  const Works works;
  works.describe("needs = [\"no-such-solver\"]\ninstall = \"apt install it\"\n");

  const auto ended = works.simulate();

  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.text, HasSubstr("no-such-solver is not installed"));
  EXPECT_THAT(ended.text, HasSubstr("apt install it"));
  EXPECT_EQ(works.call("GET", "/runs/1")["state"], "waiting");
}

TEST(ElromMaster, WrongCommandLinesAreOneLine) {
  const Works works;
  const auto fails = [&](const std::string& options, int status, const std::string& words) {
    const auto ended = works.work("el3d", options);
    EXPECT_EQ(ended.status, status) << ended.text;
    EXPECT_THAT(ended.text, HasSubstr(words));
    EXPECT_EQ(std::ranges::count(ended.text, '\n'), 1) << ended.text;
  };

  fails("", 2, "found 0 of --bundle, --study, --program");
  fails("--bundle a --study b", 2, "found 2 of --bundle, --study, --program");
  fails("--program /nothing.toml", 3, "/nothing.toml");
  fails("--program " + (works.folder / "solver/program.toml").string() + " --mesh /no.h5", 3, "/no.h5");
  fails("--study s --accept rougness", 2, "did you mean 'roughness'?");
}

}  // namespace
}  // namespace elrom::masters
