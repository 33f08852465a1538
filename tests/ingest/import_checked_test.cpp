#include "elrom/ingest/import_checked.hpp"

#include <gmock/gmock.h>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::ingest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Keeps the warnings.
class Listener : public Log {
 public:
  void message(Level level, std::string_view text) override {
    if (level == Level::warning) warnings += std::string(text) + "\n";
  }
  void progress(const Progress&) override {}
  std::string warnings;
};

class ImportChecked : public ::testing::Test {
 protected:
  static constexpr int n_cases = 12;

  /// Twelve shipped cases on a coarse mesh; the fifth with its pressure in kPa under the unit Pa.
  ImportChecked() {
    field::write_mesh(folder_ / "mesh.h5", field::make_furnace_mesh({}, 5, 6, 10));
    options_.mesh = folder_ / "mesh.h5";
    options_.store = folder_ / "store.h5";
    for (int i = 0; i < n_cases; ++i) {
      const auto name = "train_0" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ".h5";
      std::filesystem::copy_file(std::filesystem::path(ELROM_SOURCE_DIR "/data/cases") / name,
                                 folder_ / name);
      options_.files.push_back(folder_ / name);
    }
    const auto file = io::Hdf5File::open(options_.files[4], io::Hdf5File::Access::edit);
    const auto pressure = file.dataset("fields/pressure");
    auto values = pressure.read<float>();
    for (auto& value : values) value *= 1e-3f;
    pressure.write<float>(values);
  }

  test::TemporaryFolder folder_;
  ImportOptions options_;
  Listener log_;
};

TEST_F(ImportChecked, RefusesEverythingForAMistakenUnit) {
  EXPECT_THAT([&] { (void)import_checked(options_, Policy::refuse, log_); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("train_004, pressure"), HasSubstr("kPa"))));
  EXPECT_FALSE(std::filesystem::exists(options_.store));
}

TEST_F(ImportChecked, DropsTheCaseAndTakesTheOthers) {
  const auto summary = import_checked(options_, Policy::drop, log_);

  EXPECT_EQ(summary.added.size(), n_cases - 1u);
  EXPECT_TRUE(field::SnapshotStore::open(options_.store).find("train_004").empty());
  EXPECT_THAT(log_.warnings, HasSubstr("left out"));
}

// A second look at a file would find it gone.
TEST_F(ImportChecked, ReadsEachFileOnceWhateverIsDropped) {
  class Remover final : public Log {
   public:
    explicit Remover(const std::vector<std::filesystem::path>& files) : files_(files) {}
    void message(Level, std::string_view) override {}
    void progress(const Progress& progress) override {
      if (progress.done > 0) std::filesystem::remove(files_[static_cast<std::size_t>(progress.done - 1)]);
    }

   private:
    const std::vector<std::filesystem::path>& files_;
  } log(options_.files);

  EXPECT_EQ(import_checked(options_, Policy::drop, log).added.size(), n_cases - 1u);
  for (const auto& file : options_.files) EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(ImportChecked, ADroppedCaseLeavesNoTrace) {
  (void)import_checked(options_, Policy::drop, log_);
  const auto with_drop = base::sha256_file(options_.store);
  std::filesystem::remove(options_.store);
  options_.files.erase(options_.files.begin() + 4);

  (void)import_checked(options_, Policy::refuse, log_);

  EXPECT_EQ(base::sha256_file(options_.store), with_drop);
}

TEST_F(ImportChecked, KeepsTheCaseWithAWarning) {
  const auto summary = import_checked(options_, Policy::keep, log_);

  EXPECT_EQ(summary.added.size(), static_cast<std::size_t>(n_cases));
  EXPECT_THAT(log_.warnings, AllOf(HasSubstr("train_004, pressure"), HasSubstr("kept")));
}

TEST_F(ImportChecked, ComparesNewCasesWithThoseOfTheStore) {
  const auto bad = options_.files[4];
  options_.files.erase(options_.files.begin() + 4);
  (void)import_checked(options_, Policy::refuse, log_);
  options_.files = {bad};

  EXPECT_THAT([&] { (void)import_checked(options_, Policy::refuse, log_); },
              ThrowsMessage<InputError>(HasSubstr("train_004, pressure")));
}

// Once one of each dozen was told to have its solids' velocity in km/h: few cases tell little.
TEST_F(ImportChecked, ADozenSoundCasesOnACoarseMeshRaiseNoAlarm) {
  using Numbers = std::vector<const char*>;
  for (const auto& numbers :
       {Numbers{"047", "018", "058", "002", "050", "054", "042", "013", "030", "053", "061", "052"},
        Numbers{"021", "036", "009", "011", "003", "008", "012", "007", "024", "016", "017", "038"}}) {
    options_.store = folder_ / (std::string(numbers.front()) + ".h5");
    options_.files.clear();
    for (const std::string number : numbers)
      options_.files.emplace_back(ELROM_SOURCE_DIR "/data/cases/train_" + number + ".h5");

    EXPECT_EQ(import_checked(options_, Policy::refuse, log_).added.size(), numbers.size());
  }
}

TEST(Policy, UnknownNamesAreUsageErrorsWithAHint) {
  EXPECT_THAT([] { (void)policy_of("refues"); }, ThrowsMessage<UsageError>(HasSubstr("'refuse'")));
}

}  // namespace
}  // namespace elrom::ingest
