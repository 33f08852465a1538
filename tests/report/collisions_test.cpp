#include "elrom/report/collisions.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/particle/document_model.hpp"
#include "elrom/particle/exact_model.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::report {
namespace {

using particle::CollisionBundle;
using testing::HasSubstr;
using testing::Not;

const particle::ContactLaw rough{.restitution = 0.9, .friction = 0.3, .stiffness = 1e4};
constexpr std::size_t n_pairs = 400, n_test = 20;

/// Every velocity after is that of its six numbers' constant.
std::shared_ptr<const particle::CollisionModel> always(double value) {
  std::vector<particle::TreeNode> nodes;
  std::vector<particle::TreeGroup> outputs;
  for (int k = 0; k < 6; ++k) {
    outputs.push_back({value, {static_cast<std::int32_t>(nodes.size())}});
    nodes.push_back({-1, 0, 0});
  }
  return std::make_shared<particle::DocumentModel>(
      particle::DocumentPart{{Eigen::VectorXd::Zero(6), Eigen::VectorXd::Ones(6)}, {6, nodes, outputs}});
}

class Collisions : public testing::Test {
 protected:
  void SetUp() override {
    set = make_collisions(protocol, rough, 3, 0, n_pairs, {});
    write_collisions(set_file, set);
    digest = base::sha256_file(set_file);
  }

  std::filesystem::path write(const std::string& name, std::shared_ptr<const particle::CollisionModel> model,
                              const std::string& source, const particle::ContactLaw& law = rough,
                              double training_s = 12.5) const {
    CollisionBundle bundle{.model = std::move(model), .protocol = protocol, .law = law};
    bundle.provenance = {{"collisions", source}, {"training_s", std::to_string(training_s)}};
    bundle.write(folder / name);
    return folder / name;
  }

  CollisionReport report(const std::vector<std::filesystem::path>& models) const {
    return collision_report({.set = set_file, .models = models, .n_calls = 1000}, silent_log());
  }

  test::TemporaryFolder folder;
  std::filesystem::path set_file = folder / "c.h5";
  particle::Protocol protocol;
  particle::CollisionSet set;
  std::string digest;
};

TEST_F(Collisions, NumbersAreTheModelsOnTheLastPairsInJsonAndOnThePage) {
  const auto exact = std::make_shared<particle::ExactModel>(rough);
  const auto made = report({write("exact.elrom", exact, digest), write("document.elrom", always(1), digest)});
  const auto expected = errors_of(*exact, set, n_pairs - n_test, n_test);
  const auto json = nlohmann::json::parse(to_json(made));
  EXPECT_EQ(json.at("judged_pairs"), n_test);
  EXPECT_EQ(json.at("kind"), "elrom-collision-report");
  const auto& model = json.at("models").at(0);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(model.at("mae").at(k).get<double>(), expected.mae[k]);
  EXPECT_EQ(model.at("momentum_error").get<double>(), expected.momentum_error);
  EXPECT_EQ(model.at("training_s").get<double>(), 12.5);
  EXPECT_GT(model.at("calls_per_second").get<double>(), 1000);

  const auto page = html_page(made);
  for (const auto& shown : made.models)
    for (const double mae : shown.errors.mae)
      EXPECT_THAT(page, HasSubstr("<td>" + base::rounded(mae, 3) + "</td>")) << shown.name;
  EXPECT_THAT(page, HasSubstr("<h1>" + headline(made) + "</h1>"));
  EXPECT_THAT(page, HasSubstr("0.5877")) << "the source's MAE beside document";
}

TEST_F(Collisions, ThePageOpensOffline) {
  const auto page =
      html_page(report({write("exact.elrom", std::make_shared<particle::ExactModel>(rough), digest)}));
  EXPECT_THAT(page, HasSubstr("<!doctype html>"));
  for (const char* outside : {"http://", "https://", "src=", "<link", "@import", "url("})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  EXPECT_THAT(page, Not(HasSubstr("0.5877"))) << "no document model, nothing of the source's to compare";
}

TEST_F(Collisions, AModelOfAnotherLawIsMarked) {
  auto smooth = rough;
  smooth.friction = 0;
  const auto made =
      report({write("exact.elrom", std::make_shared<particle::ExactModel>(rough), digest),
              write("smooth.elrom", std::make_shared<particle::ExactModel>(smooth), digest, smooth)});
  EXPECT_TRUE(made.models[0].differs.empty());
  EXPECT_THAT(made.models[1].differs, testing::ElementsAre("contact law"));
  EXPECT_THAT(headline(made),
              HasSubstr("Misleading: exact, hard spheres (smooth.elrom) was learned for other contact law"));
  EXPECT_THAT(terminal_table(made), HasSubstr("! other contact law"));
  EXPECT_THAT(html_page(made), HasSubstr("<span class=\"verdict outside\">misleading</span>"));
}

TEST_F(Collisions, AnotherProtocolIsNamedByWhatDiffers) {
  protocol.diameter_2 = {475e-6, 475e-6};
  protocol.speed = {0, 5};
  const auto made = report({write("exact.elrom", std::make_shared<particle::ExactModel>(rough), digest)});
  EXPECT_THAT(made.models[0].differs, testing::ElementsAre("speeds", "diameters"));
}

TEST_F(Collisions, AllPairsJudgeModelsThatNeverSawTheSet) {
  const auto made = report({write("document.elrom", always(1), "another")});
  EXPECT_EQ(made.n_judged, n_pairs);
  const auto page = html_page(made);
  EXPECT_THAT(page, HasSubstr("so all of its pairs judge"));
  EXPECT_THAT(page, HasSubstr("with the same seed, these pairs are not new to it"));
}

TEST_F(Collisions, TheCostSentenceComparesTheEndsOfTheFront) {
  auto made = report({write("exact.elrom", std::make_shared<particle::ExactModel>(rough), digest),
                      write("document.elrom", always(1), digest)});
  auto &exact = made.models[0], &document = made.models[1];
  exact.errors.mae_velocity = 0.02, exact.call_seconds = 2e-8, exact.front = true, exact.training_seconds = 0;
  document.errors.mae_velocity = 0.001, document.call_seconds = 1e-7, document.front = true;
  EXPECT_THAT(cost_sentence(made),
              HasSubstr("20 times less error costs 5 times the time of a call: document"));
  EXPECT_THAT(cost_sentence(made), HasSubstr("12.5 s of training"));
  document.errors.mae_velocity = 5.08e-6;
  EXPECT_THAT(cost_sentence(made), HasSubstr("3900 times less error"));
  document.front = false;
  EXPECT_THAT(cost_sentence(made), HasSubstr("Accuracy costs nothing here: exact"));
}

TEST_F(Collisions, WithoutAModelThereIsNothingToReport) {
  EXPECT_ERROR(UsageError, "no collision model", report({}));
}

}  // namespace
}  // namespace elrom::report
