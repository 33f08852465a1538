// Predicts one case and prints the plane averages of a field:
// bundle, cases file, case, field [, file to write].
#include <cstdio>

#include "elrom/base/app.hpp"
#include "elrom/base/error.hpp"
#include "elrom/model/prediction_file.hpp"

namespace {

void print_profile(const elrom::model::Predictor& predictor, const std::vector<float>& values) {
  const auto heights = predictor.bundle().mesh().plane_heights();
  const auto& info = predictor.fields().front();
  std::printf("%10s  mean %s [%s]\n", "z [m]", info.name.c_str(), info.unit.c_str());
  for (std::size_t plane = 0; plane < predictor.planes().size(); ++plane) {
    double sum = 0;
    for (std::size_t column = 0; column < predictor.n_columns(); ++column)
      sum += values[plane * predictor.n_columns() + column];
    std::printf("%10.2f  %.6g\n", heights[plane], sum / static_cast<double>(predictor.n_columns()));
  }
}

int predict(int argc, char** argv) {
  if (argc != 5 && argc != 6) throw elrom::UsageError("arguments are: BUNDLE CASES CASE FIELD [FILE.hdf]");
  const elrom::model::Predictor predictor(argv[1], {.fields = {argv[4]}});
  for (const auto& inputs : elrom::field::read_cases(argv[2], predictor.bundle().info().schema)) {
    if (inputs.name != argv[3]) continue;
    const auto assessment = predictor.guard().assess(inputs.values);
    std::printf("%s: %s\n", inputs.name.c_str(), assessment.reason.c_str());
    std::vector<float> values(predictor.size());
    elrom::model::Predictor::Scratch scratch;  // keep it: the next call then allocates nothing
    predictor.predict(inputs.values, values, {}, scratch);
    print_profile(predictor, values);
    if (argc == 6) {
      const elrom::model::PredictionFrame frame(predictor, elrom::model::Extent(predictor.bundle()));
      elrom::model::write_prediction(
          frame, {.inputs = &inputs, .assessment = &assessment, .values = values, .half_width = {}}, argv[5]);
    }
    return 0;
  }
  throw elrom::UsageError(std::string("no such case: ") + argv[3]);
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::base::run_app("predict", [&] { return predict(argc, argv); });
}
