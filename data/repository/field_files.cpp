#include "elrom/repository/field_files.hpp"

#include <algorithm>
#include <span>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"

namespace elrom::repository {
namespace {

std::string digest_of(std::string_view bytes) { return base::sha256(std::as_bytes(std::span(bytes))); }

}  // namespace

bool is_digest(std::string_view text) {
  return text.size() == 64 &&
         std::ranges::all_of(text, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

FieldFiles::FieldFiles(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::filesystem::create_directories(folder_);
}

std::filesystem::path FieldFiles::path(const std::string& digest) const {
  if (!is_digest(digest))
    throw UsageError(Problem{
        .what = "no digest of fields", .found = "'" + digest + "'", .expected = "64 hexadecimal digits"});
  return folder_ / digest.substr(0, 2) / (digest + ".hdf");
}

std::string FieldFiles::put(std::string_view bytes) const {
  auto digest = digest_of(bytes);
  const auto target = path(digest);
  if (std::filesystem::exists(target)) return digest;
  std::filesystem::create_directories(target.parent_path());
  base::write_text(target, bytes);
  return digest;
}

bool FieldFiles::has(const std::string& digest) const { return std::filesystem::exists(path(digest)); }

std::string FieldFiles::read(const std::string& digest) const {
  auto bytes = base::read_text(path(digest));
  if (digest_of(bytes) == digest) return bytes;
  throw InputError(Problem{.what = "damaged file of fields",
                           .where = path(digest).string(),
                           .found = "bytes of another digest",
                           .advice = "restore it from a backup, or remove it and send the fields again"});
}

}  // namespace elrom::repository
