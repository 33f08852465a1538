#pragma once
// Predictions on another mesh than the reduced one: as values for the text formats, and as the start of an
// OpenFOAM run.
//
// Thread rule: const use from any thread.

#include <memory>
#include <string>

#include "elrom/fields/arguments.hpp"
#include "elrom/fields/text_writer.hpp"
#include "elrom/foam/foam_case.hpp"
#include "elrom/model/bundle.hpp"
#include "interpolation.hpp"

namespace elrom::fields {

class Onto {
 public:
  /// Reads the mesh that `arguments` name. @throws InputError for what cannot be read, UsageError for fields
  /// that the bundle lacks
  Onto(const Arguments& arguments, const model::BundleReader& bundle, int n_threads);

  [[nodiscard]] const Coordinates& coordinates() const { return coordinates_; }

  struct Placed {
    std::vector<float> values;  ///< SI, (fields, cells of the mesh)
    std::string text;           ///< what was lost or gained: an indented line, after a line break
  };
  /// Conservative: velocities and diameter keep momentum and mass (weighted by their phase's share), and
  /// solids are scaled so that what lies in the mesh is kept.
  [[nodiscard]] Placed place(const model::PredictionFrame& frame, const model::Prediction& prediction) const;
  /// Writes a time folder of the case. @return what to say of it, as in Placed
  [[nodiscard]] std::string write_time_folder(const model::PredictionFrame& frame,
                                              const model::Prediction& prediction,
                                              const std::filesystem::path& folder) const;

 private:
  void read_case(const Arguments& arguments, const model::BundleReader& bundle);
  /// @param before,after solids' volume [m3], 0: not known @param factor that made them equal; none: none did
  [[nodiscard]] std::string lines(double before, double after, std::optional<double> factor = {}) const;

  OntoOptions options_;
  std::optional<foam::FoamCase> case_;
  std::unique_ptr<foam::FoamMesh> mesh_;    //!< of a case
  std::unique_ptr<foam::FoamCells> cells_;  //!< of mesh_
  Places places_;
  Coordinates coordinates_;
  std::vector<double> source_volume_;
  double solid_density_ = 0;  //!< of a case with solids [kg/m3]
  std::unique_ptr<Interpolator> interpolator_;
};

}  // namespace elrom::fields
