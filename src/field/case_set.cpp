#include "elrom/field/case_set.hpp"

#include "elrom/base/members.hpp"

namespace elrom::field {
namespace {

template <class Row>
auto span_of(const Row& row) {
  return std::span(row.data(), static_cast<std::size_t>(row.size()));
}

}  // namespace

// Neither compiles when there is another member.
std::string CaseSet::key() const {
  const auto& [own_mesh, own_schema, own_names, own_loads, own_inputs, own_mirrors] = *this;
  return base::digest_of_members(own_mesh, own_schema.inputs(), own_names, own_loads, own_inputs,
                                 own_mirrors);
}

std::string FieldData::key() const {
  const auto& [own_cases, own_info, own_values] = *this;
  return base::digest_of_members(*own_cases, own_info, own_values);
}

std::span<const double> FieldRows::inputs(std::size_t i) const {
  return span_of(data_.cases->inputs.row(static_cast<Eigen::Index>(rows_[i])));
}

std::span<const float> FieldRows::values(std::size_t i) const {
  return span_of(data_.values.row(static_cast<Eigen::Index>(rows_[i])));
}

std::string FieldRows::key() const {
  base::Sha256 digest;
  base::add_members(digest, n_inputs());
  base::add_members(digest, n_planes());
  base::add_members(digest, n_columns());
  base::add_members(digest, info());
  for (std::size_t i = 0; i < n_cases(); ++i) {
    base::add_members(digest, load(i));
    base::add_members(digest, inputs(i));
    base::add_members(digest, values(i));
  }
  return digest.hex();
}

}  // namespace elrom::field
