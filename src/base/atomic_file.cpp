#include "elrom/base/atomic_file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::base {
namespace {

std::filesystem::path folder_of(const std::filesystem::path& target) {
  return target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
}

SystemError system_error(const std::string& what, const std::filesystem::path& where) {
  return SystemError({.what = what, .where = where.string(), .found = std::strerror(errno)});
}

void sync(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) throw system_error("cannot open for syncing", path);
  const int result = ::fsync(descriptor);
  ::close(descriptor);
  if (result != 0) throw system_error("cannot sync", path);
}

/// What the name of a temporary tells.
struct Temporary {
  std::string target;
  pid_t process;
};

bool is_digits(const std::string& text) {
  return !text.empty() && text.size() < 10 &&
         std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// Of ".<target>.<process id>.<n>.tmp"; nothing for any other name.
std::optional<Temporary> temporary_of(const std::string& name) {
  auto parts = split(name, '.');
  const auto n = parts.size();
  const bool is_ours = n >= 5 && parts[0].empty() && parts[n - 1] == "tmp" && is_digits(parts[n - 2]) &&
                       is_digits(parts[n - 3]);
  if (!is_ours) return std::nullopt;
  const pid_t process = std::stoi(parts[n - 3]);
  return Temporary{join({parts.begin() + 1, parts.end() - 3}, "."), process};
}

bool lives(pid_t process) { return ::kill(process, 0) == 0 || errno != ESRCH; }

/// Removes temporaries, files or folders, that `is_meant` says.
template <class IsMeant>
void remove_temporaries(const std::filesystem::path& folder, const IsMeant& is_meant) {
  std::error_code fault;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder, fault)) {
    const auto temporary = temporary_of(entry.path().filename().string());
    if (temporary && is_meant(*temporary)) found.push_back(entry.path());
  }
  for (const auto& path : found) std::filesystem::remove_all(path, fault);
}

}  // namespace

std::filesystem::path temporary_beside(const std::filesystem::path& target) {
  static std::atomic<int> counter{0};
  return folder_of(target) / ("." + target.filename().string() + "." + std::to_string(::getpid()) + "." +
                              std::to_string(counter++) + ".tmp");
}

AtomicFile::AtomicFile(std::filesystem::path target, Sync sync) : target_(std::move(target)), sync_(sync) {
  const auto folder = folder_of(target_);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) throw system_error("cannot write into folder", folder);
  // The rename would put a file in its place: to root's programs, /dev/null would be lost for everybody.
  std::error_code unknown;
  if (std::filesystem::is_other(std::filesystem::status(target_, unknown)))
    throw SystemError({.what = "cannot write file",
                       .where = target_.string(),
                       .found = "a device, a pipe or a socket of that name",
                       .advice = "name a file"});
  temporary_ = temporary_beside(target_);
}

AtomicFile::~AtomicFile() {
  if (!committed_) ::unlink(temporary_.c_str());
}

void AtomicFile::begin_sync() const {
  if (sync_ == Sync::none) return;
  const int descriptor = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;  // commit() tells
  ::sync_file_range(descriptor, 0, 0, SYNC_FILE_RANGE_WRITE);
  ::close(descriptor);
}

void AtomicFile::commit() {
  if (sync_ != Sync::none) sync(temporary_, O_RDONLY);
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) throw system_error("cannot rename to", target_);
  committed_ = true;
  if (sync_ == Sync::all) sync(folder_of(target_), O_RDONLY | O_DIRECTORY);
}

void write_text(const std::filesystem::path& target, std::string_view text) {
  AtomicFile file(target);
  std::ofstream stream(file.temporary(), std::ios::binary);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (!stream) throw system_error("cannot write", target);
  file.commit();
}

void expect_writable(const std::filesystem::path& target) {
  std::error_code fault;
  std::filesystem::create_directories(folder_of(target), fault);
  if (fault)
    throw SystemError(
        {.what = "cannot make folder", .where = folder_of(target).string(), .found = fault.message()});
  if (std::filesystem::is_directory(target))
    throw SystemError(
        {.what = "cannot write file", .where = target.string(), .found = "a folder of that name"});
  const AtomicFile probe(target, Sync::none);
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  if (!stream || std::filesystem::is_directory(path)) {
    throw InputError({.what = "cannot read file", .where = path.string()});
  }
  return std::move(text).str();
}

FileLock::FileLock(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  if (descriptor_ < 0) throw system_error("cannot open lock file", path);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const bool held = errno == EWOULDBLOCK;
  const auto failure = system_error("cannot lock", path);
  ::close(descriptor_);
  if (!held) throw failure;
  throw UsageError({.what = "another process is at work here",
                    .where = folder_of(path).string(),
                    .advice = "wait for it to end, or stop it"});
}

FileLock::~FileLock() { ::close(descriptor_); }

std::filesystem::path lock_beside(const std::filesystem::path& file) {
  return file.parent_path() / ("." + file.filename().string() + ".lock");
}

void remove_remains(const std::filesystem::path& target) noexcept {
  const auto name = target.filename().string();
  remove_temporaries(folder_of(target), [&](const Temporary& one) { return one.target == name; });
}

void remove_dead_remains(const std::filesystem::path& folder,
                         const std::function<bool(std::string_view)>& is_meant) {
  remove_temporaries(folder,
                     [&](const Temporary& one) { return is_meant(one.target) && !lives(one.process); });
}

}  // namespace elrom::base
