#pragma once
// Records of one field: one plane of one case each, standardised (source: eq. 6.1).

#include <mutex>

#include "elrom/field/case_set.hpp"
#include "elrom/model/banded_networks.hpp"
#include "elrom/networks/banding.hpp"
#include "elrom/networks/screening.hpp"
#include "elrom/networks/split.hpp"
#include "elrom/networks/trainer.hpp"

namespace elrom::networks {

/// What scales the inputs beside their standard deviation: nothing, the weights of a ridge fit, or the
/// inverse length scales of a Gaussian process (ARD).
enum class Relevance { none, linear, gp };

struct RecordOptions {
  model::PlaneEncodingKind encoding = model::PlaneEncodingKind::index;
  model::TransformKind transform = model::TransformKind::none;
  bool scale_cells = false;  ///< targets standardised cell by cell instead of column by column
  Relevance relevance = Relevance::none;
};

struct RecordSet {
  model::InputScaler inputs;
  model::PlaneEncoding planes;
  model::TargetTransform transform;
  model::OutputScaler outputs;
  ScreeningData records;  ///< inputs: scaled boundary conditions, then the plane's encoding
};

/// @param part (n_cases * n_planes), case by case: what is searched by. Builds have parts of their own
/// @param scaled_by the cases that scalers see, ascending; empty: all
[[nodiscard]] RecordSet make_records(const field::FieldRows& data, const std::vector<Part>& part,
                                     const RecordOptions& options,
                                     std::span<const std::size_t> scaled_by = {});

/// All that records depend on beside the data.
struct RecordRecipe {
  RecordOptions options;
  PartRule parts;
  base::Seed seed{1};  ///< of the split into parts
  /// Cases, counted among the source's and ascending, whose parts and scales hold: the records of these alone
  /// are what they would be without the others, so that their networks can be gone on with. Empty: all.
  std::vector<std::size_t> known = {};
};

/// The records of some cases of a field, made when they are first asked for: a stage that is kept needs only
/// their key. Thread rule: every member from any thread.
class RecordSource {
 public:
  /// @param data must outlive it
  RecordSource(const field::FieldData& data, std::span<const std::size_t> cases, RecordRecipe recipe);
  [[nodiscard]] const RecordSet& get() const;
  /// Of every record in one of a band's builds (build_parts()).
  [[nodiscard]] std::vector<Part> parts_of_build(BuildNumber number) const;
  /// Of the data and the recipe.
  [[nodiscard]] const std::string& key() const { return key_; }

 private:
  field::FieldRows data_;
  RecordRecipe recipe_;
  std::string key_;
  mutable std::once_flag once_;
  mutable RecordSet set_;
};

/// Records and columns of one band; with a mask, records of
/// planes that the band does not answer for are left out. @param part of each record
[[nodiscard]] TrainingProblem make_problem(const ScreeningData& records, const Band& band,
                                           std::span<const Part> part);
[[nodiscard]] inline TrainingProblem make_problem(const ScreeningData& records, const Band& band) {
  return make_problem(records, band, records.part);
}

/// How much each standardised input moves the field's principal components: 1 for the strongest input, at
/// least 0.1; empty for none.
[[nodiscard]] std::vector<double> relevance_of(Relevance kind, const MatrixD& inputs, const MatrixF& values);

}  // namespace elrom::networks
