#pragma once
// Reports of a model's versions: elrom-report's pages, made when somebody first asks for one, and places
// where a browser may open them. Who follows a link sends no token, so that each opening has a place of its
// own, which nobody guesses and which is soon gone.
//
// Thread rule: any thread.

#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "elrom/study/versions.hpp"

namespace elrom::serve {

/// Files that who knows a secret may read for some time.
class Places {
 public:
  explicit Places(std::chrono::duration<double> open_for) : open_for_(open_for) {}

  /// @return the secret
  [[nodiscard]] std::string open(const std::filesystem::path& file);
  /// Nothing: there is no such place, or no longer.
  [[nodiscard]] std::optional<std::filesystem::path> file(const std::string& secret) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Place {
    std::filesystem::path file;
    Clock::time_point end;
  };
  std::chrono::duration<double> open_for_;
  mutable std::mutex mutex_;
  std::map<std::string, Place> places_;  //!< by the secret's hash: looking for it tells nothing of it
};

class Reports {
 public:
  /// @param folder where they are kept @param program elrom-report; empty: none are made
  Reports(std::filesystem::path folder, std::filesystem::path program)
      : folder_(std::move(folder)), program_(std::move(program)) {}

  /// Of the version that answers its accuracy, of another how it compares with that one; up to a minute's
  /// work when it is not there yet.
  /// @param number of a version that is there
  /// @throws NotFoundError where none are made; ConflictError while one is; InputError with elrom-report's
  ///         reason
  [[nodiscard]] std::filesystem::path of(const std::filesystem::path& study, const study::Versions& versions,
                                         int number) const;

  Places places{std::chrono::minutes(10)};

 private:
  void make(const std::filesystem::path& study, const study::Versions& versions, int number,
            const std::filesystem::path& file) const;

  std::filesystem::path folder_, program_;
};

}  // namespace elrom::serve
