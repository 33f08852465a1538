#pragma once
// Results of stages under the digest of everything they depend on:
// STUDY/stages/<stage>-<name>-<digest>.elrom, tensor files of kind "elrom-stage" (data/FORMATS.md). A second
// run finds what is still valid and redoes the rest; results of other inputs stay until they are pruned, so
// that going back to earlier settings costs nothing.
//
// A stage is a plain struct of all that its result depends on, and what computes it is a member that sees
// nothing else, so that its key, made of every member, cannot leave an input out:
//
//   struct Screening {
//     static constexpr const char* stage = "screen";
//     static constexpr int version = 1;  // the next one when other code gives another result
//     const RecordSource* records;       // has a key() of its own (base/members.hpp)
//     ScreenSettings settings;
//     [[nodiscard]] TensorFile compute(const StageContext&) const;  // no result depends on it
//   };

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "elrom/base/log.hpp"
#include "elrom/base/members.hpp"
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

/// Of the stage's name, the version of its code and every member.
template <class Stage>
[[nodiscard]] std::string stage_key(const Stage& stage) {
  return base::digest_of_members(std::string_view(Stage::stage), Stage::version, stage);
}

/// Thread rule: get() from any thread, for different results.
class StageCache {
 public:
  /// @param folder made when missing; empty: nothing is kept, everything is computed
  explicit StageCache(std::filesystem::path folder = {}, Log& log = silent_log());

  /// What the stage's compute() gave, from the file when it is there and whole, else computed now and kept.
  /// @param name for people, any characters
  template <class Stage, class Context>
  [[nodiscard]] TensorFile get(const std::string& name, const Stage& stage, const Context& context) const {
    return get(Stage::stage, name, stage_key(stage), [&] { return stage.compute(context); });
  }
  /// Path for a file of a stage's own under the same rule, kind "checkpoint"; empty when nothing is kept.
  template <class Stage>
  [[nodiscard]] std::filesystem::path path(const std::string& kind, const std::string& name,
                                           const Stage& stage, const std::string& ending) const {
    return path(kind, name, stage_key(stage), ending);
  }
  [[nodiscard]] StageClock& clock() const { return clock_; }

 private:
  // By a digest made by hand: not for callers.
  [[nodiscard]] TensorFile get(const std::string& stage, const std::string& name, const std::string& digest,
                               const std::function<TensorFile()>& make) const;
  [[nodiscard]] std::filesystem::path path(const std::string& stage, const std::string& name,
                                           const std::string& digest, const std::string& ending) const;
  [[nodiscard]] bool read(const std::filesystem::path& path, const std::string& digest,
                          TensorFile& file) const;

  std::filesystem::path folder_;
  Log& log_;
  mutable StageClock clock_;
};

}  // namespace elrom::io
