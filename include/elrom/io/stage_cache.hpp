#pragma once
// Results of stages under the digest of everything they depend on:
// STUDY/stages/<stage>-<name>-<digest>.elrom, tensor files of kind "elrom-stage" (data/FORMATS.md). A second
// run finds what is still valid and redoes the rest; results of other inputs stay until they are pruned, so
// that going back to earlier settings costs nothing.

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "elrom/base/log.hpp"
#include "elrom/io/tensor_file.hpp"

namespace elrom::io {

/// Seconds spent, and results taken from the cache, by stage; for timing.json. Thread rule: any thread.
class StageClock {
 public:
  struct Entry {
    double seconds = 0;  ///< wall time, summed over results (side by side they add up to more than the run)
    std::int64_t computed = 0, reused = 0;
  };
  void add(const std::string& stage, double seconds, bool reused);
  [[nodiscard]] std::map<std::string, Entry> entries() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Entry> entries_;
};

/// Thread rule: get() from any thread, for different results.
class StageCache {
 public:
  /// @param folder made when missing; empty: nothing is kept, everything is computed
  explicit StageCache(std::filesystem::path folder = {}, Log& log = silent_log());

  /// What `make` gave for this digest, from the file when it is there and whole, else computed now and kept.
  /// @param stage "screen", "build" ... @param name for people, any characters
  [[nodiscard]] TensorFile get(const std::string& stage, const std::string& name, const std::string& digest,
                               const std::function<TensorFile()>& make) const;
  [[nodiscard]] bool has(const std::string& stage, const std::string& name, const std::string& digest) const;
  /// Path for a file of a caller's own under the same rule ("checkpoint"); empty when nothing is kept.
  [[nodiscard]] std::filesystem::path path(const std::string& stage, const std::string& name,
                                           const std::string& digest, const std::string& ending) const;
  [[nodiscard]] StageClock& clock() const { return clock_; }

 private:
  [[nodiscard]] bool read(const std::filesystem::path& path, const std::string& digest,
                          TensorFile& file) const;

  std::filesystem::path folder_;
  Log& log_;
  mutable StageClock clock_;
};

}  // namespace elrom::io
