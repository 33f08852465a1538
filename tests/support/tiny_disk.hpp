#pragma once
// A file system of its own that is soon full; gone with the object. Mounting needs rights that not
// everybody has.

#include <sys/mount.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>

namespace elrom::test {

class TinyDisk {
 public:
  /// @param size as mount takes it: "64k"
  TinyDisk(const std::filesystem::path& folder, const std::string& size) : folder_(folder) {
    std::filesystem::create_directories(folder);
    mounted_ = ::mount("tmpfs", folder.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
    if (!mounted_) reason_ = std::strerror(errno);
  }
  ~TinyDisk() {
    if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  TinyDisk(const TinyDisk&) = delete;
  TinyDisk& operator=(const TinyDisk&) = delete;
  [[nodiscard]] bool mounted() const { return mounted_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  std::filesystem::path folder_;
  bool mounted_ = false;
  std::string reason_;
};

/// Takes all the room there is, until it goes.
class Ballast {
 public:
  explicit Ballast(std::filesystem::path file) : file_(std::move(file)) {
    std::FILE* const stream = std::fopen(file_.c_str(), "wb");
    if (stream == nullptr) return;
    std::setvbuf(stream, nullptr, _IONBF, 0);
    for (const std::size_t size : {std::size_t{1} << 20, std::size_t{1} << 12, std::size_t{1}}) {
      const std::string block(size, 'x');
      while (std::fwrite(block.data(), 1, size, stream) == size) {
      }
    }
    std::fclose(stream);
  }
  ~Ballast() {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }
  Ballast(const Ballast&) = delete;
  Ballast& operator=(const Ballast&) = delete;

 private:
  std::filesystem::path file_;
};

}  // namespace elrom::test
