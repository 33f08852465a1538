#include "coefficient_kinds.hpp"

#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/model/coefficient_models.hpp"
#include "elrom/model/mlp_coefficients.hpp"
#include "elrom/model/smoother_coefficients.hpp"
#include "model_parts.hpp"

namespace elrom::model {

// A new kind: add its line to the table.
std::span<const CoefficientKind> coefficient_kinds() {
  static const std::vector<CoefficientKind> kinds{{"linear", LinearCoefficients::load},
                                                  {"gp", GpCoefficients::load},
                                                  {"rbf", RbfCoefficients::load},
                                                  {"smoother", SmootherCoefficients::load},
                                                  {"mlp", MlpCoefficients::load}};
  return kinds;
}

std::unique_ptr<CoefficientModel> load_coefficient_model(const io::TensorFile& file,
                                                         const std::string& prefix) {
  const std::string where = file.where() + ":" + prefix;
  const std::string kind = text_of(read_description(file, prefix), "kind", where);
  std::vector<std::string> names;
  for (const CoefficientKind& entry : coefficient_kinds()) {
    if (entry.name == kind) return entry.load(file, prefix);
    names.emplace_back(entry.name);
  }
  throw InputError({.what = "unknown kind of coefficients '" + kind + "'",
                    .where = where,
                    .advice = base::name_advice(kind, names) + "; a newer ELROM may have written it"});
}

}  // namespace elrom::model
