#include "tar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"

namespace elrom::serve {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t block = 512;

/// Fields by their places in POSIX.1-1988, octal numbers as text.
std::string header_of(const std::string& name, std::size_t size) {
  constexpr std::size_t longest_name = 99, checksum_at = 148, checksum_size = 8;
  if (name.size() > longest_name)
    throw InputError(Problem{.what = "a name too long for an archive", .found = name});
  std::string header(block, '\0');
  const auto put = [&](std::size_t at, const std::string& text) { header.replace(at, text.size(), text); };
  put(0, name);
  put(100, "0000644");
  put(108, "0000000");
  put(116, "0000000");
  put(124, fmt::format("{:011o}", size));
  put(136, fmt::format("{:011o}", 0));
  put(156, "0");
  put(257, std::string("ustar\0", 6) + "00");
  put(checksum_at, std::string(checksum_size, ' '));
  unsigned sum = 0;
  for (const char c : header) sum += static_cast<unsigned char>(c);
  put(checksum_at, fmt::format("{:06o}", sum) + '\0' + ' ');
  return header;
}

}  // namespace

std::string tar_of(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& one : fs::recursive_directory_iterator(folder))
    if (one.is_regular_file()) files.push_back(one.path());
  std::ranges::sort(files);
  std::string archive;
  for (const auto& file : files) {
    const auto content = base::read_text(file);
    archive += header_of(fs::relative(file, folder.parent_path()).generic_string(), content.size()) + content;
    archive.resize((archive.size() + block - 1) / block * block, '\0');
  }
  return archive.append(2 * block, '\0');
}

}  // namespace elrom::serve
