#include "elrom/study/case_effects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

#include "elrom/model/bundle.hpp"
#include "elrom/study/study.hpp"
#include "study_fixture.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::study {
namespace {

/// A model of 20 sound cases, 4 of them held out; then three sound ones more, and one whose fields are upside
/// down.
class NewCases : public ::testing::Test {
 protected:
  NewCases() { write_small_store(store_path(), 20); }
  void grow() const {
    write_small_store(store_path(), 3, 20);
    const auto store = field::SnapshotStore::open(store_path());
    field::SnapshotWriter writer(store_path(), store.mesh(), store.schema(), store.fields());
    const auto sound = store.find("train_12").front();
    field::Snapshot poison{.record = store.cases()[sound], .fields = {}};
    poison.record.inputs.name = "poison";
    poison.record.inputs.values[1] += 0.01;
    poison.fields.resize(2, static_cast<Eigen::Index>(store.mesh().n_cells()));
    for (Eigen::Index f = 0; f < 2; ++f)
      poison.fields.row(f) =
          -store.read(store.fields()[static_cast<std::size_t>(f)].name, std::array{sound}).row(0);
    writer.add(poison);
    writer.commit();
  }
  [[nodiscard]] CaseEffects effects(const std::string& method, bool hold_out) const {
    std::vector<std::string> lines{"effort=quick", "method=" + method, "peers.networks=false"};
    if (!hold_out) lines.emplace_back("split.held_out=[]");
    const auto settings = read_settings(folder_ / "study.toml", lines);
    const auto model = folder_ / "model_of_test.elrom";
    (void)Study(folder_.path(), settings, {}, silent_log(), {}).fit(model);
    grow();
    const Study study(folder_.path(), settings, {}, silent_log(), {});
    return effects_of({"train_20", "poison", "train_21"}, model, study.gate_cases(), 2);
  }
  [[nodiscard]] std::filesystem::path store_path() const { return folder_ / "snapshots.h5"; }

  test::TemporaryFolder folder_;
};

TEST_F(NewCases, ThePoisonedOneHurtsMostOnHeldOutCases) {
  const auto found = effects("kernel", true);

  EXPECT_EQ(found.judged_on, "held-out cases");
  ASSERT_EQ(found.cases.size(), 3u);
  EXPECT_EQ(found.cases.front().name, "poison");
  EXPECT_GT(found.cases.front().change, 0.02) << to_json(found);
  EXPECT_LT(found.cases[1].change, found.cases.front().change / 2);
  EXPECT_EQ(found.cases.front().fields.size(), 2u);
  EXPECT_THAT(in_words(found, 0.01), ::testing::StartsWith("poison hurts"));
}

TEST_F(NewCases, WithoutHeldOutCasesTheEarlierOnesJudge) {
  const auto found = effects("kernel", false);

  EXPECT_EQ(found.judged_on, "leave-one-out");
  ASSERT_EQ(found.cases.size(), 3u);
  EXPECT_EQ(found.cases.front().name, "poison");
  EXPECT_GT(found.cases.front().change, 0);
}

TEST_F(NewCases, WithoutAClosedFormItIsSaid) {
  const auto found = effects("linear", true);

  EXPECT_TRUE(found.cases.empty());
  EXPECT_THAT(found.left_out, ::testing::ElementsAre("pressure", "gas_velocity_z"));
  EXPECT_THAT(in_words(found, 0.01), ::testing::HasSubstr("for want of a closed form, for pressure"));
  EXPECT_EQ(nlohmann::json::parse(to_json(found))["no_closed_form"].size(), 2u);
}

}  // namespace
}  // namespace elrom::study
