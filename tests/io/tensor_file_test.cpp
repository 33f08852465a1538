#include "elrom/io/tensor_file.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::io {
namespace {

using test::read_bytes;
using test::TemporaryFolder;
using test::write_bytes;
using ::testing::HasSubstr;

TensorFile sample() {
  TensorFile file;
  file.set_text("kind", "test \"quoted\" \u00b5m");
  file.set("weights", Tensor::copy(MatrixF(MatrixF::Random(5, 7))));
  file.set("odd/bytes", Tensor::copy(std::array<std::uint8_t, 3>{1, 2, 255}, {3}));
  file.set("scale", Tensor::copy(std::array{1.5, -2.25, 1e300}, {3}));
  file.set("index", Tensor::copy(std::array<std::int32_t, 4>{-1, 0, 7, 1 << 30}, {2, 2}));
  file.set("nothing", Tensor::copy(std::span<const float>{}, {0, 4}));
  return file;
}

/// A file around a hand-made header: the way to try what the writer never writes. `json` holds the mark
/// DIGEST where the header's own digest belongs.
std::string framed(std::string json, const std::string& data) {
  const auto mark = json.find("DIGEST");
  if (mark != std::string::npos) {
    const std::string before = json.substr(0, mark), after = json.substr(mark + 6);
    json = before + base::Sha256().add(std::string_view(before)).add(std::string_view(after)).hex() + after;
  }
  const std::uint64_t length = json.size();
  std::string bytes(8, '\0');
  std::memcpy(bytes.data(), &length, 8);
  return bytes + json + data;
}

std::string message_of(const std::filesystem::path& path) {
  try {
    (void)TensorFile::open(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TensorFile, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const auto written = sample();
  written.write(folder / "a");

  const auto read = TensorFile::open(folder / "a");

  EXPECT_EQ(read.texts(), written.texts());
  ASSERT_EQ(read.tensors().size(), written.tensors().size());
  for (const auto& [name, tensor] : written.tensors()) {
    EXPECT_EQ(read.tensor(name).type(), tensor.type()) << name;
    EXPECT_EQ(read.tensor(name).shape(), tensor.shape()) << name;
    EXPECT_TRUE(std::ranges::equal(read.tensor(name).bytes(), tensor.bytes())) << name;
  }
  EXPECT_NO_THROW(read.verify_all(2));
  EXPECT_EQ(read.digest(), written.digest());
}

TEST(TensorFile, SameContentGivesSameBytes) {
  const TemporaryFolder folder;
  const auto file = sample();

  file.write(folder / "a");
  TensorFile::open(folder / "a").write(folder / "b");

  EXPECT_EQ(read_bytes(folder / "a"), read_bytes(folder / "b"));
}

TEST(TensorFile, HasTheSafetensorsLayout) {
  const TemporaryFolder folder;
  sample().write(folder / "a");

  const std::string bytes = read_bytes(folder / "a");
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), 8);
  const auto header = nlohmann::json::parse(bytes.substr(8, length));

  EXPECT_EQ((8 + length) % 64, 0);
  EXPECT_EQ(header["scale"]["dtype"], "F64");
  EXPECT_EQ(header["scale"]["shape"], nlohmann::json::array({3}));
  const std::size_t begin = header["scale"]["data_offsets"][0];
  double second = 0;
  std::memcpy(&second, bytes.data() + 8 + length + begin + 8, 8);
  EXPECT_EQ(second, -2.25);
  const std::size_t odd = header["odd/bytes"]["data_offsets"][0];
  const auto digest = base::sha256(std::as_bytes(std::span(bytes).subspan(8 + length + odd, 3)));
  EXPECT_EQ(header["__metadata__"]["sha256:tensor/odd/bytes"], digest);
}

TEST(TensorFile, EveryFlippedByteIsFound) {
  const TemporaryFolder folder;
  sample().write(folder / "a");
  const std::string good = read_bytes(folder / "a");

  std::size_t found = 0;
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    write_bytes(folder / "bad", bad);
    try {
      TensorFile::open(folder / "bad").verify_all();
      ADD_FAILURE() << "byte " << i << " of " << good.size() << " was changed and not noticed";
    } catch (const InputError&) {
      ++found;
    }
  }
  EXPECT_EQ(found, good.size());
}

TEST(TensorFile, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  sample().write(folder / "a");
  const std::string good = read_bytes(folder / "a");

  for (std::size_t n = 0; n < good.size(); ++n) {
    write_bytes(folder / "cut", good.substr(0, n));
    EXPECT_THROW((void)TensorFile::open(folder / "cut"), InputError) << n << " bytes";
  }
  write_bytes(folder / "long", good + "x");
  EXPECT_THROW((void)TensorFile::open(folder / "long"), InputError);
}

TEST(TensorFile, OpenReadsNoTensorButVerifyFindsTheDamagedOne) {
  const TemporaryFolder folder;
  sample().write(folder / "a");
  std::string bytes = read_bytes(folder / "a");
  const auto place = bytes.find("\x01\x02\xff");
  ASSERT_NE(place, std::string::npos);
  bytes[place] = 9;
  write_bytes(folder / "a", bytes);

  const auto file = TensorFile::open(folder / "a");

  EXPECT_NO_THROW(file.verify("weights"));
  try {
    file.verify("odd/bytes");
    FAIL() << "the damage was not noticed";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder / "a").string() + ":odd/bytes"));
  }
}

struct HostileHeader {
  const char* name;
  const char* json;
  const char* data;
  const char* fault;
};

class HostileHeaders : public ::testing::TestWithParam<HostileHeader> {};

TEST_P(HostileHeaders, AreRefusedWithTheReason) {
  const TemporaryFolder folder;
  write_bytes(folder / "hostile", framed(GetParam().json, GetParam().data));

  EXPECT_THAT(message_of(folder / "hostile"), HasSubstr(GetParam().fault));
}

#define ELROM_DIGESTED "\"__metadata__\":{\"sha256:header\":\"DIGEST\"}"
INSTANTIATE_TEST_SUITE_P(
    TensorFile, HostileHeaders,
    ::testing::Values(
        HostileHeader{
            "DuplicateTensor",
            R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]},"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}})",
            "x", "tensor 'a' twice"},
        HostileHeader{"DuplicateText", R"({"__metadata__":{"k":"1","k":"2"}})", "",
                      "metadata name 'k' twice"},
        HostileHeader{"DuplicateMember",
                      R"({"a":{"dtype":"U8","dtype":"U8","shape":[1],"data_offsets":[0,1]}})", "x",
                      "'dtype' of tensor 'a' twice"},
        HostileHeader{
            "Overlap",
            R"({"a":{"dtype":"U8","shape":[2],"data_offsets":[0,2]},"b":{"dtype":"U8","shape":[2],"data_offsets":[1,3]}})",
            "xyz", "a hole or an overlap before tensor 'b'"},
        HostileHeader{"Hole", R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[1,2]}})", "xy",
                      "a hole or an overlap"},
        HostileHeader{"LeftOver", R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}})", "xy",
                      "2 bytes of data"},
        HostileHeader{"OverflowingShape",
                      R"({"a":{"dtype":"F32","shape":[4294967296,4294967296],"data_offsets":[0,0]}})", "",
                      "whose shape and place differ"},
        HostileHeader{"ReversedPlace", R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[1,0]}})", "x",
                      "whose shape and place differ"},
        HostileHeader{"NegativeSize", R"({"a":{"dtype":"U8","shape":[-1],"data_offsets":[0,1]}})", "x",
                      "negative"},
        HostileHeader{"FractionalSize", R"({"a":{"dtype":"U8","shape":[1.5],"data_offsets":[0,1]}})", "x",
                      "whole number"},
        HostileHeader{"HugeNumber",
                      R"({"a":{"dtype":"U8","shape":[99999999999999999999],"data_offsets":[0,1]}})", "x",
                      "whole number"},
        HostileHeader{"UnknownType", R"({"a":{"dtype":"BF16","shape":[1],"data_offsets":[0,2]}})", "xy",
                      "type 'BF16'"},
        HostileHeader{"MissingMember", R"({"a":{"dtype":"U8","shape":[1]}})", "x",
                      "without dtype, shape or data_offsets"},
        HostileHeader{"UnknownMember", R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1],"x":"y"}})",
                      "x", "a text at 'x'"},
        HostileHeader{"NumberInMetadata", R"({"__metadata__":{"k":1}})", "", "a number outside"},
        HostileHeader{"NestedObject", R"({"a":{"dtype":{"b":{}}}})", "", "an object inside 'a'"},
        HostileHeader{"TopLevelList", "[[[[[[]]]]]]", "", "no JSON object"},
        HostileHeader{"TextBehindTheObject", "{}{}", "", "no JSON"},
        HostileHeader{"NotJson", "{\"a\"", "", "no JSON"},
        HostileHeader{"NoDigest", "{}", "", "does not match its SHA-256"},
        HostileHeader{"TensorWithoutDigest",
                      "{" ELROM_DIGESTED R"(,"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]}})", "x",
                      "tensor without a digest"}),
    [](const auto& test) { return test.param.name; });

TEST(TensorFile, RefusesAHeaderLongerThanTheFileOrTheLimit) {
  const TemporaryFolder folder;
  for (const std::uint64_t length : {std::uint64_t{100}, std::uint64_t{100'000'001}, ~std::uint64_t{0}}) {
    std::string bytes(8, '\0');
    std::memcpy(bytes.data(), &length, 8);
    write_bytes(folder / "a", bytes + "{}");
    EXPECT_THROW((void)TensorFile::open(folder / "a"), InputError) << length;
  }
}

TEST(TensorFile, RefusesWhatIsNoRegularFile) {
  const TemporaryFolder folder;

  EXPECT_THAT(message_of(folder.path()), HasSubstr("no regular file"));
  EXPECT_THAT(message_of(folder / "missing"), HasSubstr("missing"));
}

TEST(TensorFile, MissingTensorNamesTheNearest) {
  try {
    (void)sample().tensor("weigths");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'weights'?"));
  }
}

TEST(TensorFile, WritesNothingThatItWouldNotRead) {
  const TemporaryFolder folder;
  TensorFile file;
  for (int i = 0; i <= 16'384; ++i) file.set("a" + std::to_string(i), Tensor::copy(std::array{1.0F}, {1}));

  EXPECT_ERROR(UsageError, "16385 tensors", file.write(folder / "many"));
  EXPECT_FALSE(std::filesystem::exists(folder / "many"));
}

TEST(TensorFile, ShapeIsCheckedWithRoomForAnySize) {
  const auto file = sample();

  EXPECT_NO_THROW((void)file.tensor("weights", std::array<std::size_t, 2>{any_size, 7}));
  EXPECT_NO_THROW((void)file.tensor("nothing", std::array<std::size_t, 2>{any_size, 4}));
  EXPECT_THROW((void)file.tensor("weights", std::array<std::size_t, 2>{0, 7}), InputError);
  EXPECT_THROW((void)file.tensor("weights", std::array<std::size_t, 2>{7, 5}), InputError);
  EXPECT_THROW((void)file.tensor("weights", std::array<std::size_t, 1>{35}), InputError);
}

TEST(Tensor, RefusesAViewOfAnotherTypeOrRank) {
  const auto tensor = Tensor::copy(MatrixF(MatrixF::Zero(2, 3)));

  EXPECT_EQ(tensor.matrix().rows(), 2);
  EXPECT_THROW((void)tensor.f64(), InputError);
  EXPECT_THROW((void)tensor.matrix64(), InputError);
  EXPECT_THROW((void)Tensor::copy(std::array<float, 8>{}, {2, 2, 2}).matrix(), InputError);
  EXPECT_TRUE(Tensor().empty());
  EXPECT_EQ(Tensor().size(), 0U);
}

}  // namespace
}  // namespace elrom::io
