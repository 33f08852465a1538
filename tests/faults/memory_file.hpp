#pragma once
// Files for a fuzzer: in memory where the system has a place for that, one folder a process.

#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>

#include "support/temporary_folder.hpp"

namespace elrom::faults {

inline const std::filesystem::path& memory_folder() {
  static const test::TemporaryFolder kept(
      access("/dev/shm", W_OK) == 0 ? "/dev/shm" : std::filesystem::temp_directory_path());
  return kept.path();
}

/// A file of these bytes, in place of the one of that name before. A fork shares the folder, not the files.
inline std::filesystem::path memory_file(const std::string& name, std::span<const std::uint8_t> bytes) {
  auto path = memory_folder() / (std::to_string(getpid()) + name);
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const auto written = file < 0 ? -1 : write(file, bytes.data(), bytes.size());
  if (file >= 0) close(file);
  if (written != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("cannot write a file for the fuzzer");
  return path;
}

}  // namespace elrom::faults
