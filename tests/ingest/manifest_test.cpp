// The shipped cases are what their manifest and their table say, and stay small.

#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {
namespace {

const std::filesystem::path data_folder = ELROM_SOURCE_DIR "/data";

nlohmann::json manifest() {
  return nlohmann::json::parse(base::read_text(data_folder / "cases" / "manifest.json"));
}

TEST(Manifest, DigestsAreThoseOfTheFiles) {
  const auto whole = manifest();
  for (const auto& entry : whole["cases"]) {
    const auto path = data_folder / "cases" / entry["file"].get<std::string>();
    EXPECT_EQ(base::sha256_file(path), entry["sha256"].get<std::string>()) << path;
  }
}

TEST(Manifest, ListsEveryCaseOnce) {
  const auto whole = manifest();
  std::set<std::string> listed, present;
  for (const auto& entry : whole["cases"]) EXPECT_TRUE(listed.insert(entry["file"]).second);
  for (const auto& entry : std::filesystem::directory_iterator(data_folder / "cases")) {
    if (entry.path().extension() == ".h5") present.insert(entry.path().filename());
  }

  EXPECT_EQ(listed, present);
}

TEST(Manifest, HoldsEnoughCasesOfEachRole) {
  const auto whole = manifest();
  std::map<std::string, int> roles;
  for (const auto& entry : whole["cases"]) ++roles[entry["role"]];

  EXPECT_GE(roles["train"], 48);
  EXPECT_EQ(roles["held-out"], 5);
  EXPECT_EQ(roles["repeat"], 4);
}

TEST(Manifest, TheTableOfCasesAgreesWithTheExports) {
  const auto table = data_folder / "cases" / "cases.csv";
  const auto schema = field::read_schema(table);

  for (const auto& row : field::read_cases(table, schema)) {
    const auto one = read_el3d(data_folder / "cases" / (row.name + ".h5"));
    ASSERT_EQ(one.schema, schema);
    EXPECT_NEAR(one.record.inputs.load, row.load, 1e-4);
    for (std::size_t i = 0; i < schema.size(); ++i) {
      EXPECT_NEAR(one.record.inputs.values[i], row.values[i], 1e-5 * std::abs(row.values[i]))
          << row.name << " " << schema[i].name;
    }
  }
}

TEST(Manifest, TheDataFolderStaysSmall) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }

  EXPECT_LT(bytes, 25'000'000U);
}

}  // namespace
}  // namespace elrom::ingest
