#pragma once
// A run of elrom-predict in memory, with values that tell where they belong.

#include "elrom/model/prediction_file.hpp"
#include "support/mesh_part.hpp"

namespace elrom::test {

/// Two fields on 2 x 2 columns and 3 planes; value of field f in cell c = 100 (f + 1) + c.
struct SampleRun {
  field::Mesh mesh = field::make_furnace_mesh({}, 2, 2, 3);
  model::PredictionFrame frame;
  field::CaseInputs inputs{"case_a", 0.64, {1.5, 2.5}};
  model::Assessment assessment;
  std::vector<float> values;

  explicit SampleRun(const model::Excerpt& excerpt = {})
      : frame(model::Extent(mesh_part(mesh, excerpt.planes), mesh.n_planes, excerpt)) {
    frame.fields = {field::field_info("pressure"), field::field_info("gas_velocity_z")};
    frame.fields[0].unit = "Pa";
    frame.schema = field::InputSchema({{"air", "kg/s", "t/h"}, {"fuel", "kg/s", "kg/s"}});
    frame.bundle_digest = std::string(64, 'b');
    frame.mesh_digest = mesh.digest();
    frame.bundle_program = "ELROM";
    frame.method = "networks";
    assessment.reason = "as good as trained";
    assessment.nearest = {{"train_1", 0.6, 0.1}};
    const auto& cells = frame.extent.cells();
    for (std::size_t f = 0; f < 2; ++f) {
      for (std::size_t i = 0; i < cells.size(); ++i)
        values.push_back(static_cast<float>(100 * (f + 1)) + static_cast<float>(cells.number(i)));
    }
  }
  [[nodiscard]] model::Prediction prediction() const {
    return {.inputs = &inputs, .assessment = &assessment, .values = values, .half_width = {}};
  }
};

}  // namespace elrom::test
