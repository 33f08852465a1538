#pragma once
// A run of elrom-predict in memory, with values that tell where they belong.

#include <memory>

#include "../../predict/fields/prediction.hpp"
#include "support/mesh_part.hpp"

namespace elrom::test {

/// Two fields on 2 x 2 columns and 3 planes; value of field f in cell c = 100 (f + 1) + c.
struct SampleRun {
  field::Mesh mesh = field::make_furnace_mesh({}, 2, 2, 3);
  fields::Run run;
  field::CaseInputs inputs{"case_a", 0.64, {1.5, 2.5}};
  model::Assessment assessment;
  std::vector<float> values;

  explicit SampleRun(const std::vector<std::int32_t>& planes = {},
                     const std::optional<fields::Box>& box = {}) {
    run.fields = {field::field_info("pressure"), field::field_info("gas_velocity_z")};
    run.fields[0].unit = "Pa";
    run.schema = field::InputSchema({{"air", "kg/s", "t/h"}, {"fuel", "kg/s", "kg/s"}});
    const auto part = planes.empty() ? mesh : mesh_part(mesh, planes);
    run.cells = fields::choose_cells(part, planes, box);
    run.geometry = fields::geometry_of(part, run.cells);
    run.bundle_digest = std::string(64, 'b');
    run.mesh_digest = mesh.digest();
    run.bundle_program = "ELROM";
    run.method = "networks";
    assessment.reason = "as good as trained";
    assessment.nearest = {{"train_1", 0.6, 0.1}};
    for (std::size_t f = 0; f < 2; ++f) {
      for (const auto cell : run.cells.cells)
        values.push_back(static_cast<float>(100 * (f + 1)) + static_cast<float>(cell));
    }
  }
  [[nodiscard]] fields::Prediction prediction() const {
    return {.inputs = &inputs, .assessment = &assessment, .values = values, .half_width = {}};
  }
};

}  // namespace elrom::test
