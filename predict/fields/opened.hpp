#pragma once
// What a run of elrom-predict has open before its first case:
// cases, model, what is written of it, and where it lies.

#include <memory>
#include <optional>
#include <vector>

#include "case_list.hpp"
#include "elrom/fields/arguments.hpp"
#include "elrom/fields/physics.hpp"
#include "elrom/fields/text_writer.hpp"
#include "elrom/model/prediction_file.hpp"
#include "onto.hpp"
#include "timing.hpp"

namespace elrom::fields {

/// Thread rule: const use from any number of threads.
struct Opened {
  CaseList list;
  std::optional<Physics> physics;          ///< only with --audit or --conserve
  std::optional<Coordinates> coordinates;  ///< only with text formats
  std::unique_ptr<const Onto> onto;        ///< only with --onto
  model::Predictor predictor;
  model::PredictionFrame frame;
};

/// @param timing open, read and prepare are filled in
/// @throws InputError, UsageError: whatever is wrong with bundle, cases, or what is asked of them
[[nodiscard]] Opened open(const Arguments& arguments, int n_threads, Timing& timing);

}  // namespace elrom::fields
