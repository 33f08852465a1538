// Every kind of file in every container: the same rule, in the same
// words. The readers of each kind are tested with their files.
#include "elrom/io/file_kind.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/io/stage_cache.hpp"
#include "elrom/io/tensor_file.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::io {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// What a container's check says of a file with such a head: the version, or the message.
using Check =
    std::function<std::string(const std::string& kind, FormatVersion version, const FileKind& expected)>;

template <class Read>
std::string answer(const Read& read) {
  try {
    return read().text();
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string of_text(const std::string& kind, FormatVersion version, const FileKind& expected) {
  return answer([&] { return check_kind({kind, version.text(), "ELROM X"}, expected, "f"); });
}

std::string of_hdf5(const std::string& kind, FormatVersion version, const FileKind& expected) {
  const test::TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "f");
  write_kind(file, {kind, version, ""});
  file.set_text("program", "ELROM X");
  return answer([&] { return check_kind(file, expected); });
}

std::string of_tensors(const std::string& kind, FormatVersion version, const FileKind& expected) {
  TensorFile file;
  write_kind(file, {kind, version, ""});
  file.set_text("program", "ELROM X");
  return answer([&] { return check_kind(file, expected); });
}

std::string of_json(const std::string& kind, FormatVersion version, const FileKind& expected) {
  auto root = json_head<nlohmann::ordered_json>({kind, version, ""});
  root["program"] = "ELROM X";
  const auto read = nlohmann::json::parse(root.dump());
  return answer([&] { return check_json_kind(read, expected, "f"); });
}

const std::map<std::string, Check> containers{
    {"text", of_text}, {"hdf5", of_hdf5}, {"tensors", of_tensors}, {"json", of_json}};

/// The message without the file's name, which differs.
std::string without_place(const std::string& message) {
  const auto from = message.find(" in "), to = message.find(": found");
  return from == std::string::npos ? message : message.substr(0, from) + message.substr(to);
}

class EveryKind : public ::testing::TestWithParam<FileKind> {
 protected:
  /// What all containers say alike.
  [[nodiscard]] std::string said(const std::string& kind, FormatVersion version) const {
    std::set<std::string> answers;
    for (const auto& [name, check] : containers)
      answers.insert(without_place(check(kind, version, GetParam())));
    EXPECT_EQ(answers.size(), 1u) << ::testing::PrintToString(answers);
    return *answers.begin();
  }
  const std::string name_{GetParam().name};
  const FormatVersion ours_ = GetParam().version;
};

TEST_P(EveryKind, OurOwnVersionIsRead) { EXPECT_EQ(said(name_, ours_), ours_.text()); }

TEST_P(EveryKind, AnOlderAndANewerMinorVersionAreRead) {
  EXPECT_EQ(said(name_, {ours_.major, 0}), FormatVersion({ours_.major, 0}).text());
  EXPECT_EQ(said(name_, {ours_.major, ours_.minor + 12}),
            FormatVersion({ours_.major, ours_.minor + 12}).text());
}

TEST_P(EveryKind, ANewerAndAnOlderMajorVersionAreRefused) {
  for (const int major : {ours_.major + 1, ours_.major - 1}) {
    EXPECT_EQ(said(name_, {major, 3}),
              "another format version: found " + name_ + " " + std::to_string(major) + ".3, expected " +
                  name_ + " " + std::to_string(ours_.major) +
                  ".x; use the ELROM that wrote it (ELROM X), or " + std::string(GetParam().remedy));
  }
}

TEST_P(EveryKind, AnotherKindIsRefused) {
  for (const auto& other : kinds::all) {
    if (other.name == name_) continue;
    EXPECT_EQ(said(std::string(other.name), ours_),
              "wrong kind of file: found " + std::string(other.name) + ", expected " + name_);
  }
}

INSTANTIATE_TEST_SUITE_P(, EveryKind, ::testing::ValuesIn(kinds::all), [](const auto& test) {
  std::string name(test.param.name);
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(FileKind, AHeadThatIsMissingOrDamagedIsRefused) {
  const auto told = [](const FoundKind& found) {
    return answer([&] { return check_kind(found, kinds::mesh, "f"); });
  };
  EXPECT_EQ(told({}), "wrong kind of file in f: found no kind, expected elrom-mesh");
  EXPECT_THAT(told({.kind = "elrom-mesh"}),
              HasSubstr("found elrom-mesh without a version, expected elrom-mesh 1.x"));
  for (const auto* format :
       {"", "1", "1.", ".0", "1.0.0", "-1.0", "1.-1", "1.x", "one", "1.0 ", "99999999999.0"})
    EXPECT_THAT(told({.kind = "elrom-mesh", .format = format}), StartsWith("damaged format version in f"))
        << format;
}

TEST(FileKind, AJsonDocumentOfAnotherShapeIsRefused) {
  const auto told = [](const char* text) {
    const auto root = nlohmann::json::parse(text, nullptr, false);
    return answer([&] { return check_json_kind(root, kinds::split, "f"); });
  };
  for (const auto* text : {"no json", "[1]", "3", "{}"})
    EXPECT_THAT(told(text), HasSubstr("found no kind")) << text;
  for (const auto* format : {"1", "[1]", "[1, 0, 0]", "[1.5, 0]", "{}", "null"})
    EXPECT_THAT(told((R"({"kind": "elrom-split", "format": )" + std::string(format) + "}").c_str()),
                StartsWith("damaged format version"))
        << format;
}

TEST(FileKind, NamesAreUniqueAndDocumented) {
  std::ifstream file(std::filesystem::path(ELROM_SOURCE_DIR) / "data" / "FORMATS.md");
  const std::string formats((std::istreambuf_iterator<char>(file)), {});
  std::set<std::string_view> names;
  for (const auto& kind : kinds::all) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_THAT(formats, HasSubstr(kind.name));
  }
}

// What is not in `all` is checked by no test here.
TEST(FileKind, TheTableHoldsEachOfThem) {
  std::ifstream file(std::filesystem::path(ELROM_SOURCE_DIR) / "include/elrom/io/file_kind.hpp");
  const std::string header((std::istreambuf_iterator<char>(file)), {}),
      declared = "inline constexpr FileKind ";
  std::size_t n_declared = 0;
  for (auto at = header.find(declared); at != std::string::npos; at = header.find(declared, at + 1))
    ++n_declared;
  EXPECT_EQ(n_declared, kinds::all.size());
}

// A kind that is spelled out is one that was written or read past the table and its check.
TEST(FileKind, KindsAreSpelledOutInTheTableAlone) {
  const std::filesystem::path root(ELROM_SOURCE_DIR);
  for (const auto* folder : {"include", "src", "data", "train", "predict"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const auto extension = entry.path().extension();
      if ((extension != ".cpp" && extension != ".hpp") || entry.path().filename() == "file_kind.hpp")
        continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);) {
        if (line.find("hash.add(std::string_view(\"elrom-mesh\"))") != std::string::npos)
          continue;  // begins a digest
        line.resize(std::min(line.size(), line.find("//")));
        for (const auto& kind : kinds::all)
          EXPECT_EQ(line.find('"' + std::string(kind.name) + '"'), std::string::npos)
              << entry.path() << ": " << line;
      }
    }
}

/// The context counts how often it is computed.
struct AnswerStage {
  static constexpr const char* stage = "build";
  static constexpr int version = 1;
  int question = 0;
  [[nodiscard]] TensorFile compute(int* const& made) const {
    ++*made;
    TensorFile file;
    file.set_text("answer", "42");
    return file;
  }
};

TEST(StageCache, AKeptResultOfANewerMinorVersionIsTakenAndOfANewerMajorOneMadeAgain) {
  const test::TemporaryFolder folder;
  const StageCache cache(folder.path());
  const AnswerStage stage{7};
  int made = 0;
  const auto get = [&] { return cache.get("x", stage, &made); };
  static_cast<void>(get());
  const auto path = cache.path("build", "x", stage, ".elrom");
  const auto mark = [&](const FileKind& as) {
    TensorFile copy;
    const auto file = TensorFile::open(path);
    for (const auto& [key, text] : file.texts()) copy.set_text(key, text);
    write_kind(copy, as);
    copy.write(path);
  };

  mark({kinds::stage.name, {1, 5}, ""});
  EXPECT_EQ(get().text("answer"), "42");
  EXPECT_EQ(made, 1);
  mark({kinds::stage.name, {2, 0}, ""});
  EXPECT_EQ(get().text("answer"), "42");
  EXPECT_EQ(made, 2);
  mark(kinds::bundle);
  static_cast<void>(get());
  EXPECT_EQ(made, 3);
}

}  // namespace
}  // namespace elrom::io
