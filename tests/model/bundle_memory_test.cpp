// What reading a bundle may cost: twice its size in memory (its pages and as much again), whoever made it.

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "../../src/io/tensor_header.hpp"
#include "elrom/base/child_process.hpp"
#include "elrom/base/error.hpp"
#include "elrom/model/predictor.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::model {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t megabyte = std::size_t{1} << 20;

/// In children, so that memory which the making of a file leaves behind is not at the reader's disposal.
void in_child(const std::string& name, std::size_t memory_bytes, const std::function<void()>& work) {
  base::try_in_child(name, "bundle", work, {.seconds = 60, .memory_bytes = memory_bytes});
}

/// Processor time of the children that have ended.
double seconds_of_children() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

void read_whole(const fs::path& path) {
  io::TensorFile::open(path).verify_all();
  BundleReader bundle(path);
  (void)bundle.mesh();
  const std::vector<double> inputs(bundle.info().schema.size(), 1.0);
  const Predictor predictor(std::move(bundle), {.interval_level = 0.5});
  (void)predictor.guard().assess(inputs);
  std::vector<float> values(predictor.size()), widths(predictor.size());
  Predictor::Scratch scratch;
  predictor.predict(inputs, values, widths, scratch);
}

/// A file of this header with its true digest, and nothing behind it.
void write_header(const fs::path& path, std::string json) {
  const std::string mark = R"("sha256:header":")";
  json.replace(json.find(mark) + mark.size(), io::digest_length, io::header_digest(json));
  const std::uint64_t length = json.size();
  std::string bytes(sizeof length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  test::write_bytes(path, bytes + json);
}

std::string repeated(const std::string& piece, std::size_t bytes, const std::string& separator = "") {
  std::string text = piece;
  while (text.size() + separator.size() + piece.size() < bytes) text += separator + piece;
  return text;
}

/// A header of about `bytes` whose "bundle" is this text.
std::string header_with(const std::string& bundle) {
  return R"({"__metadata__":{"kind":"elrom-bundle","format":"1.0","sha256:header":")" +
         std::string(io::digest_length, '0') + R"(","bundle":)" + nlohmann::json(bundle).dump() + "}}";
}

std::string header_of_many_tensors(std::size_t bytes) {
  std::string metadata = R"({"__metadata__":{"sha256:header":")" + std::string(io::digest_length, '0') + '"',
              tensors;
  for (int i = 0; metadata.size() + tensors.size() < bytes; ++i) {
    const auto name = std::to_string(i);
    metadata += ",\"sha256:tensor/" + name + "\":\"\"";
    tensors += ",\"" + name + R"(":{"dtype":"U8","shape":[0],"data_offsets":[0,0]})";
  }
  return metadata + "}" + tensors + "}";
}

TEST(BundleMemory, ALargeBundleCostsAtMostTwiceItsSize) {
  const test::TemporaryFolder folder;
  const auto path = folder / "large.elrom";
  in_child("making", 2048 * megabyte, [&] {
    test::sample_bundle({.n_x = 20,
                         .n_y = 42,
                         .n_planes = 66,
                         .n_inputs = 26,
                         .n_submodels = 5,
                         .n_builds = 5,
                         .n_units = 128})
        .write(path);
  });
  const auto size = fs::file_size(path);
  ASSERT_GT(size, 30 * megabyte);

  EXPECT_NO_THROW(in_child("reading", 2 * size, [&] { read_whole(path); }));
  // The limit is felt: the pages alone need the size itself.
  EXPECT_ERROR(InputError, "", in_child("reading", size / 2, [&] { read_whole(path); }));
}

TEST(BundleMemory, AHostileHeaderCostsLittle) {
  const test::TemporaryFolder folder;
  const auto path = folder / "hostile.elrom";
  for (const std::size_t bytes : {io::largest_header - 1000, std::uint64_t{40} * megabyte}) {
    for (const auto& [name, header] : std::map<std::string, std::string>{
             {"tensors", header_of_many_tensors(bytes)},
             {"one text", header_with(std::string(bytes - 1000, 'x'))},
             {"nested", header_with(std::string(bytes - 1000, '['))},
             {"numbers", header_with("[" + repeated("1", bytes - 1000, ",") + "]")},
             {"names", header_with(R"({"cases":[)" + repeated(R"("a")", bytes / 2, ",") + "]}")}}) {
      in_child("making", 2048 * megabyte, [&] { write_header(path, header); });
      const auto limit = fs::file_size(path) + std::max<std::size_t>(fs::file_size(path), 16 * megabyte);
      const double begin = seconds_of_children();

      try {
        in_child(name, limit, [&] { read_whole(path); });
        ADD_FAILURE() << name << " was taken";
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), ::testing::Not(::testing::AnyOf(::testing::HasSubstr("too much memory"),
                                                                  ::testing::HasSubstr("crashed"))))
            << name << " of " << bytes;
      }

      EXPECT_LT(seconds_of_children() - begin, 1) << name << " of " << bytes;
    }
  }
}

}  // namespace
}  // namespace elrom::model
