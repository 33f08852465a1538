// Files of users are tried in a child process before this one opens them.
#include <sys/stat.h>

#include <set>
#include <tuple>

#include "elrom/base/child_process.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::io {
namespace {

/// What must be the same for a file to be the same one: place on the disk, size, time of its last change.
using Identity = std::tuple<std::string, dev_t, ino_t, off_t, std::time_t, long>;

base::ChildLimits limits_for(std::size_t bytes) {
  constexpr std::size_t gigabyte = std::size_t{1} << 30, megabyte = std::size_t{1} << 20;
  // Packed fields grow on reading; a gigabyte is enough for the library and for any small file.
  return {.seconds = 60 + static_cast<double>(bytes / megabyte), .memory_bytes = gigabyte + 32 * bytes};
}

}  // namespace

void survive(const std::filesystem::path& path, const std::string& work_name,
             const std::function<void()>& work) {
  static std::set<Identity> survivors;
  struct stat status {};
  const bool there = ::stat(path.c_str(), &status) == 0;
  const Identity identity{work_name,      status.st_dev,         status.st_ino,
                          status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
  if (there && survivors.contains(identity)) return;
  base::try_in_child("the HDF5 library", path.string(), work,
                     limits_for(there ? static_cast<std::size_t>(status.st_size) : 0));
  survivors.insert(identity);
}

}  // namespace elrom::io
