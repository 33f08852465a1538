#pragma once
// All fields of a case, or only what is asked: the library's front door for C++ callers.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::model {

/// What to load and compute.
struct Selection {
  std::vector<std::string> fields;  ///< empty: all
  field::Planes planes;
  bool best_build_only = false;
  std::optional<double> interval_level;  ///< half-widths of the prediction interval are computed when set
  /// A field's model is read when it is first predicted, not at once: the quickest way to a single
  /// prediction. What is wrong with its tensors is then told by predict().
  bool load_on_use = false;
  int n_threads = 1;  ///< used while loading
};

/// Inputs beyond the trained range are held at one trained width outside it before a model sees them
/// (Guard::hold): far extrapolation is noise at best, and so every field stays finite. The guard judges, and
/// reports, the inputs as given. Thread rule: const use from any number of threads, each with a Scratch of
/// its own.
class Predictor {
 public:
  /// Loads just what `selection` names: those fields' models, of networks the builds and the submodels of
  /// those planes. @throws InputError, UsageError (unknown field or plane)
  explicit Predictor(const std::filesystem::path& bundle, Selection selection = {});
  explicit Predictor(BundleReader bundle, Selection selection = {});
  ~Predictor();
  Predictor(Predictor&&) noexcept;

  struct Scratch {
    std::vector<Workspace> workspaces;  ///< one a thread
    std::vector<double> held_inputs;
  };

  [[nodiscard]] const BundleReader& bundle() const;
  [[nodiscard]] const Selection& selection() const;  ///< as asked for
  [[nodiscard]] const Guard& guard() const;
  [[nodiscard]] const std::vector<field::FieldInfo>& fields() const;  ///< selected, in the bundle's order
  [[nodiscard]] std::span<const std::int32_t> planes() const;         ///< numbers of those selected
  [[nodiscard]] std::size_t n_columns() const;
  /// Values of one case: fields() x planes() x n_columns.
  [[nodiscard]] std::size_t size() const { return fields().size() * planes().size() * n_columns(); }

  /// What a caller does while a case is predicted, on the threads that predict it.
  struct Alongside {
    std::function<void()> first;  ///< one thread does it before it predicts
    /// Told of each field when its values are there, by the thread that computed the last of them.
    std::function<void(std::size_t i_field)> ready;
  };
  /// @param inputs SI, in the bundle's schema order, (n_inputs)
  /// @param values (size()), field by field, SI, inside the fields' physical bounds
  /// @param half_width (size()) when interval_level is set, else empty
  /// From the second call on nothing is allocated (beyond starting threads, with n_threads > 1).
  /// @throws NumericalError when an input is not finite, or a model's result is not
  void predict(std::span<const double> inputs, std::span<float> values, std::span<float> half_width,
               Scratch& scratch, int n_threads = 1, const Alongside& alongside = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::model
