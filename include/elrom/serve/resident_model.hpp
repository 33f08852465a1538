#pragma once
// A bundle that stays open, and the next one in its place when the study's `current` moves. Who is answered
// by the old one is answered by it to the end.
//
// Thread rule: any thread.

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/base/large_array.hpp"
#include "elrom/model/predictor.hpp"

namespace elrom::serve {

class Cuts;

/// One bundle, whole in memory, each field by itself, so that who asks for one waits for one.
class OpenModel {
 public:
  /// Level of the intervals, where the bundle has any.
  static constexpr double level = 0.9;

  /// @throws InputError for a file that is no bundle of ours
  explicit OpenModel(const std::filesystem::path& bundle);
  ~OpenModel();

  [[nodiscard]] const model::BundleReader& bundle() const { return bundle_; }
  [[nodiscard]] const field::InputSchema& schema() const { return bundle_.info().schema; }
  [[nodiscard]] const model::Guard& guard() const { return guard_; }
  [[nodiscard]] const std::vector<field::FieldInfo>& fields() const { return bundle_.info().fields; }
  /// Values of one field: planes x columns.
  [[nodiscard]] std::size_t n_cells() const { return bundle_.n_planes() * bundle_.n_columns(); }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] std::string name() const { return file_.filename().string(); }  ///< "3.elrom"
  [[nodiscard]] bool has_intervals() const { return has_intervals_; }
  /// Read of the mesh when it is first asked for. @throws InputError for a broken mesh
  [[nodiscard]] const Cuts& cuts() const;

  struct Values {
    base::LargeArray<float> values, half_width;  ///< (i_fields, n_cells), SI; the second may be empty
  };
  /// @param i_fields numbers among fields() @param intervals asked for, where the bundle has them
  /// @throws NumericalError
  [[nodiscard]] Values predict(std::span<const double> inputs, std::span<const std::size_t> i_fields,
                               bool intervals, int n_threads) const;

 private:
  model::BundleReader bundle_;
  model::Guard guard_;
  std::filesystem::path file_;
  bool has_intervals_;
  std::vector<std::unique_ptr<model::Predictor>> plain_, with_intervals_;  //!< one a field

  using Scratch = std::unique_ptr<model::Predictor::Scratch>;
  [[nodiscard]] Scratch take_scratch() const;
  mutable std::mutex mutex_;
  mutable std::vector<Scratch> scratch_;  //!< of no field now
  mutable std::once_flag cuts_once_;
  mutable std::unique_ptr<const Cuts> cuts_;
};

class ResidentModel {
 public:
  /// @param where a bundle's file, or a study's folder, whose model.elrom is meant; may come to be later
  explicit ResidentModel(std::filesystem::path where);

  /// nullptr: there is none yet
  [[nodiscard]] std::shared_ptr<const OpenModel> now() const;
  /// Takes up the bundle that is there now, if it is another. @return whether it was
  /// @throws InputError for one that cannot be used; the one before goes on
  bool look();

 private:
  struct Identity {
    std::filesystem::path file;
    std::uintmax_t size = 0;
    std::filesystem::file_time_type changed;
    bool operator==(const Identity&) const = default;
  };
  [[nodiscard]] std::optional<Identity> found() const;

  std::filesystem::path where_;
  std::mutex looking_;
  std::optional<Identity> looked_at_;  //!< guarded by `looking_`
  mutable std::mutex mutex_;
  std::shared_ptr<const OpenModel> model_;  //!< guarded by `mutex_`
};

}  // namespace elrom::serve
