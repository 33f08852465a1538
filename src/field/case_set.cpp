#include "elrom/field/case_set.hpp"

#include "elrom/base/digest.hpp"

namespace elrom::field {

std::string data_digest(const FieldData& data, std::span<const std::size_t> cases) {
  base::Sha256 digest;
  digest.add(data.info.name).add(data.cases->mesh.digest());
  for (const auto& input : data.cases->schema.inputs()) digest.add(input.name);
  for (const auto row : cases) {
    const auto i = static_cast<Eigen::Index>(row);
    digest.add_value(data.cases->loads[row]);
    digest.add(std::as_bytes(
        std::span(data.cases->inputs.row(i).data(), static_cast<std::size_t>(data.cases->inputs.cols()))));
    digest.add(
        std::as_bytes(std::span(data.values.row(i).data(), static_cast<std::size_t>(data.values.cols()))));
  }
  return digest.hex();
}

}  // namespace elrom::field
