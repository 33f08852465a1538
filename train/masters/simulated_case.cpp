#include "simulated_case.hpp"

#include "elrom/model/prediction_file.hpp"

namespace elrom::masters {

std::string case_name(const std::string& model, const std::string& inputs_digest) {
  constexpr std::size_t enough = 12;  // 48 bits tell any number of cases apart
  return model + "_" + inputs_digest.substr(0, enough);
}

void write_simulation(const field::SnapshotStore& store, const std::string& program,
                      const std::filesystem::path& file) {
  const auto& mesh = store.mesh();
  model::PredictionFrame frame{model::Extent(mesh, mesh.n_planes)};
  frame.fields = store.fields();
  frame.schema = store.schema();
  frame.mesh_digest = mesh.digest();
  frame.bundle_program = program;
  frame.method = "simulation";
  const std::size_t only = 0;
  std::vector<float> values;
  for (const auto& info : frame.fields) {
    const auto field = store.read(info.name, std::span(&only, 1));
    values.insert(values.end(), field.data(), field.data() + field.size());
  }
  const auto& inputs = store.cases().front().inputs;
  model::Assessment assessment;
  assessment.reason = "simulated by " + program;
  model::write_prediction(frame, {.inputs = &inputs, .assessment = &assessment, .values = values}, file);
}

}  // namespace elrom::masters
