#include "timing.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

namespace elrom::fields {

std::string Timing::text(std::size_t n_cases) const {
  constexpr double ms = 1e3;
  std::string text = fmt::format(
      "time [ms]: open {:.2f}, read {:.2f}, prepare output {:.2f}, compute {:.2f}, write {:.2f}, whole run "
      "{:.2f}",
      ms * open, ms * read, ms * prepare, ms * compute, ms * write, ms * wall);
  if (n_cases > 1) text += fmt::format(" ({:.4g} cases/s)", static_cast<double>(n_cases) / wall);
  return text;
}

double cached_share(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  struct stat status {};
  const bool known = ::fstat(file, &status) == 0 && status.st_size > 0;
  const auto size = known ? static_cast<std::size_t>(status.st_size) : 0;
  void* address = known ? ::mmap(nullptr, size, PROT_READ, MAP_SHARED, file, 0) : MAP_FAILED;
  ::close(file);
  if (address == MAP_FAILED) return 0;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> resident((size + page - 1) / page, 0);
  const bool told = ::mincore(address, size, resident.data()) == 0;
  ::munmap(address, size);
  if (!told) return 0;
  const auto n =
      std::count_if(resident.begin(), resident.end(), [](unsigned char bits) { return (bits & 1) != 0; });
  return static_cast<double>(n) / static_cast<double>(resident.size());
}

std::string page_faults() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return fmt::format("{} page faults read from disk, {} from memory", usage.ru_majflt, usage.ru_minflt);
}

}  // namespace elrom::fields
