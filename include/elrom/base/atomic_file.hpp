#pragma once
// A file that appears whole or not at all: written beside its target, synced, renamed, directory synced.

#include <filesystem>
#include <functional>
#include <string_view>

namespace elrom::base {

/// What survives a power cut right after commit(): `all`, the new file; `content`, the old file or the new
/// one, whole; `none`, nothing is waited for.
enum class Sync { none, content, all };

/// Owns the temporary path until commit(); without commit the temporary is removed and the target is
/// untouched. The temporary lies in the target's folder (rename must not cross file systems), under a name of
/// its own (temporary_beside), so two writers never share one.
class AtomicFile {
 public:
  /// @throws SystemError when the folder does not exist or is not writable, or the target is no file
  explicit AtomicFile(std::filesystem::path target, Sync sync = Sync::all);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Has the system send what was written so far to the disk,
  /// and waits for nothing: commit() then waits less.
  void begin_sync() const;
  /// The writer has closed the temporary; makes it the target. @throws SystemError
  void commit();

 private:
  std::filesystem::path target_, temporary_;
  Sync sync_;
  bool committed_ = false;
};

/// Beside `target` and hidden: ".<target>.<process id>.<n>.tmp"; another one each time it is asked for.
[[nodiscard]] std::filesystem::path temporary_beside(const std::filesystem::path& target);

/// Whole text as `target`, atomically.
void write_text(const std::filesystem::path& target, std::string_view text);
/// For a file that long work ends with: makes its folder, and sees that a file can be made there, so that
/// nobody waits for what cannot be written. @throws SystemError
void expect_writable(const std::filesystem::path& target);
/// @throws InputError when it cannot be read
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// Holds an advisory lock (flock) on `path` for as long as it lives, so that two processes never work in one
/// study or on one store. @throws UsageError at once when another process holds it
class FileLock {
 public:
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};
/// The lock file of one file, beside it: ".<name>.lock".
[[nodiscard]] std::filesystem::path lock_beside(const std::filesystem::path& file);
/// Temporaries that killed writers of `target` left behind: for
/// who holds its lock, so that they are nobody's.
void remove_remains(const std::filesystem::path& target) noexcept;
/// The same of all targets in a folder that `is_meant` names, for who holds no lock: temporaries, files or
/// folders, whose process is no more.
void remove_dead_remains(const std::filesystem::path& folder,
                         const std::function<bool(std::string_view target_name)>& is_meant);

}  // namespace elrom::base
