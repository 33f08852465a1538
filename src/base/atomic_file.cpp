#include "elrom/base/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "elrom/base/error.hpp"

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

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target, Sync sync) : target_(std::move(target)), sync_(sync) {
  static std::atomic<int> counter{0};
  const auto folder = folder_of(target_);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) throw system_error("cannot write into folder", folder);
  temporary_ = folder / ("." + target_.filename().string() + "." + std::to_string(::getpid()) + "." +
                         std::to_string(counter++) + ".tmp");
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
  const auto prefix = "." + target.filename().string() + ".";
  std::error_code fault;
  for (const auto& entry : std::filesystem::directory_iterator(folder_of(target), fault)) {
    const auto name = entry.path().filename().string();
    if (name.starts_with(prefix) && name.ends_with(".tmp")) std::filesystem::remove(entry.path(), fault);
  }
}

}  // namespace elrom::base
