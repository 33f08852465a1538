#include "elrom/study/versions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/model/bundle.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::study {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

class SomeVersions : public ::testing::Test {
 protected:
  /// A bundle that differs from those of other numbers.
  void write_bundle(const fs::path& path, int number) const {
    fs::create_directories(path.parent_path());
    auto bundle = test::sample_bundle({.n_fields = 1});
    bundle.info.provenance["content"] = std::to_string(number);
    bundle.write(path);
  }
  void add(Versions& versions, int number, bool promoted, const std::string& by = "run") const {
    if (!fs::exists(versions.file(number))) write_bundle(versions.file(number), number);
    versions.record({.number = number, .by = by, .promoted = promoted});
  }
  [[nodiscard]] std::string content_of_model() const {
    return model::BundleReader(model()).info().provenance.at("content");
  }
  [[nodiscard]] fs::path study() const { return folder_.path(); }
  [[nodiscard]] fs::path model() const { return study() / "model.elrom"; }

  test::TemporaryFolder folder_;
};

TEST_F(SomeVersions, TheCurrentOneAnswersUnderTheNameOfTheModel) {
  Versions versions(study());
  EXPECT_EQ(versions.next(), 1);
  add(versions, 1, true);
  add(versions, 2, true);
  add(versions, 3, false);

  EXPECT_EQ(versions.current(), 2);
  EXPECT_EQ(content_of_model(), "2");
  EXPECT_EQ(fs::read_symlink(model()), fs::path("models/current"));
  EXPECT_EQ(fs::read_symlink(study() / "models" / "current"), fs::path("2.elrom"));
  EXPECT_EQ(versions.next(), 4);
}

TEST_F(SomeVersions, TheLogReadsBack) {
  {
    Versions versions(study());
    write_bundle(versions.file(1), 1);
    versions.record({.number = 1, .by = "run", .promoted = true, .date = "2026-11-24"});
    write_bundle(versions.file(2), 2);
    versions.record({.number = 2, .by = "retrain", .promoted = false, .verdict = R"({"passed":false})"});
  }

  const Versions versions(study());

  ASSERT_EQ(versions.log().size(), 2u);
  EXPECT_EQ(versions.log()[0].date, "2026-11-24");
  EXPECT_FALSE(versions.log()[0].parent);
  EXPECT_EQ(versions.log()[0].digest, model::BundleReader(versions.file(1)).digest());
  EXPECT_GT(versions.log()[0].n_cases, 0u);
  EXPECT_EQ(versions.log()[1].parent, 1);
  EXPECT_EQ(versions.log()[1].verdict, R"({"passed":false})");
  ASSERT_NE(versions.last_of(2), nullptr);
  EXPECT_FALSE(versions.last_of(2)->promoted);
}

TEST_F(SomeVersions, GoingBackTwiceGoesBackTwo) {
  Versions versions(study());
  for (const int number : {1, 2, 3}) add(versions, number, true);

  EXPECT_EQ(versions.previous(), 2);
  add(versions, 2, true, "rollback");
  EXPECT_EQ(versions.previous(), 1);
  add(versions, 1, true, "rollback");
  EXPECT_FALSE(versions.previous());
  EXPECT_EQ(content_of_model(), "1");
}

TEST_F(SomeVersions, AModelFromBeforeThereWereVersionsIsTakenInAsTheFirst) {
  write_bundle(model(), 7);
  const auto bytes = test::read_bytes(model());

  Versions(study()).settle();

  const Versions versions(study());
  EXPECT_EQ(versions.current(), 1);
  EXPECT_TRUE(fs::is_symlink(model()));
  EXPECT_EQ(test::read_bytes(versions.file(1)), bytes);
  ASSERT_EQ(versions.log().size(), 1u);
  EXPECT_EQ(versions.log()[0].by, "taken in");
}

// Killed after the file got its second name, and before the log or the links were written.
TEST_F(SomeVersions, TakingInGoesOnWhereItWasStopped) {
  write_bundle(model(), 7);
  fs::create_directories(study() / "models");
  fs::create_hard_link(model(), study() / "models" / "1.elrom");

  Versions(study()).settle();

  EXPECT_THAT(Versions(study()).numbers(), ElementsAre(1));
  EXPECT_TRUE(fs::is_symlink(model()));
  EXPECT_EQ(content_of_model(), "7");
}

TEST_F(SomeVersions, ABundleCopiedOverTheModelBecomesAVersion) {
  Versions versions(study());
  add(versions, 1, true);
  fs::remove(model());
  write_bundle(model(), 9);

  Versions(study()).settle();

  EXPECT_EQ(Versions(study()).current(), 2);
  EXPECT_EQ(content_of_model(), "9");
}

// The log is written first: a process that ended before it moved the link has decided all the same.
TEST_F(SomeVersions, ADecisionInTheLogIsCarriedOut) {
  Versions versions(study());
  add(versions, 1, true);
  add(versions, 2, true);
  fs::remove(study() / "models" / "current");
  fs::create_symlink("1.elrom", study() / "models" / "current");

  Versions(study()).settle();

  EXPECT_EQ(Versions(study()).current(), 2);
}

TEST_F(SomeVersions, ALostLogBeginsAnewWithTheVersionsThatAreThere) {
  Versions versions(study());
  for (const int number : {1, 2, 3}) add(versions, number, number < 3);
  fs::remove(study() / "models" / "log.json");
  Versions found(study());
  EXPECT_TRUE(found.has_lost_its_log());

  found.settle();

  const Versions after(study());
  EXPECT_FALSE(after.has_lost_its_log());
  EXPECT_EQ(after.current(), 2);
  EXPECT_EQ(content_of_model(), "2");
  ASSERT_EQ(after.log().size(), 3u);
  EXPECT_EQ(after.log().back().number, 2);
  EXPECT_TRUE(after.log().back().promoted);
  EXPECT_EQ(after.log().back().by, "taken in");
  EXPECT_EQ(after.next(), 4);
}

TEST_F(SomeVersions, ALogThatCannotBeReadIsLeftAsItIs) {
  Versions versions(study());
  add(versions, 1, true);
  base::write_text(study() / "models" / "log.json", "{\"kind\": ");

  EXPECT_ERROR(InputError, "a new one begins with the versions", Versions(study()));
  EXPECT_EQ(base::read_text(study() / "models" / "log.json"), "{\"kind\": ");
}

TEST_F(SomeVersions, ARefusalIsKnownBesideTheSamePresentOneAlone) {
  Versions versions(study());
  add(versions, 1, true);
  write_bundle(versions.file(2), 2);
  const VersionEvent refusal{
      .number = 2, .by = "retrain", .promoted = false, .verdict = R"({"passed": false})"};
  EXPECT_FALSE(versions.is_known(refusal));
  versions.record(refusal);
  EXPECT_TRUE(versions.is_known(refusal));
  EXPECT_FALSE(versions.is_known({.number = 2, .by = "run", .promoted = true}));
  EXPECT_FALSE(
      versions.is_known({.number = 2, .by = "run", .promoted = false, .verdict = R"({"passed": 0})"}));

  add(versions, 3, true);
  EXPECT_FALSE(versions.is_known(refusal)) << "another one answers now";
}

TEST_F(SomeVersions, AModelThatCannotBeReadIsPutAside) {
  base::write_text(model(), "no bundle");

  Versions(study()).settle();

  EXPECT_FALSE(fs::exists(model()));
  EXPECT_TRUE(fs::exists(study() / "model.elrom.unreadable"));
}

TEST_F(SomeVersions, AnUnknownNumberIsRefusedWithThoseThatAreThere) {
  Versions versions(study());
  add(versions, 1, true);
  add(versions, 2, false);

  EXPECT_ERROR(UsageError, "known are: 1, 2", versions.known(5));
}

TEST_F(SomeVersions, ANewerLogIsRefused) {
  fs::create_directories(study() / "models");
  base::write_text(study() / "models" / "log.json",
                   R"({"kind": "elrom-versions", "format": [2, 0], "events": []})");

  EXPECT_ERROR(InputError, "log.json", Versions(study()));
}

}  // namespace
}  // namespace elrom::study
