#include "elrom/fields/physics.hpp"

#include <algorithm>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::fields {
namespace {

constexpr const char* repaired_fields[] = {"solid_volume_fraction", "gas_velocity_z"};

std::string option_of(const Arguments& arguments) { return arguments.audit ? "--audit" : "--conserve"; }

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_cells(const Arguments& arguments, const model::BundleReader& bundle, const model::Cells& cells) {
  if (cells.size() == bundle.n_planes() * bundle.n_columns()) return;
  throw UsageError({.what = option_of(arguments) + " needs all cells",
                    .found = std::to_string(cells.size()) + " of " +
                             std::to_string(bundle.n_planes() * bundle.n_columns()),
                    .advice = "leave out --planes and --region"});
}

void check_fields(const Arguments& arguments, const model::BundleReader& bundle) {
  std::vector<std::string> in_bundle;
  for (const auto& info : bundle.info().fields) in_bundle.push_back(info.name);
  const auto needed = arguments.audit ? std::span<const char* const>(model::audited_fields)
                                      : std::span<const char* const>(repaired_fields);
  for (const std::string name : needed) {
    const std::string what = option_of(arguments) + " needs field '" + name + "'";
    if (!contains(in_bundle, name)) {
      throw UsageError({.what = what, .advice = "the bundle has no such field"});
    }
    if (!arguments.fields.empty() && !contains(arguments.fields, name)) {
      throw UsageError({.what = what, .advice = "add it to --fields, or leave out --fields"});
    }
  }
}

void check_inputs(const Arguments& arguments, const model::BundleReader& bundle) {
  if (!arguments.conserve || contains(bundle.info().schema.names(), "solids_inventory")) return;
  throw UsageError(
      {.what = std::string("--conserve needs input 'solids_inventory'"),
       .advice = "the bundle was trained without it, so that nothing says how much to conserve"});
}

// Where gas enters and how dense solids are, nothing but the furnace says.
field::Furnace furnace_of(const Arguments& arguments, const model::BundleReader& bundle) {
  if (auto furnace = bundle.furnace()) return *std::move(furnace);
  throw UsageError(
      {.what = option_of(arguments) + " needs a furnace description",
       .where = bundle.file().where(),
       .found = "none",
       .advice = "describe the furnace to the store (elrom-data import --furnace) and train again"});
}

std::string indented(const std::string& lines) {
  std::string text;
  for (const auto& line : base::split(lines, '\n')) {
    if (!line.empty()) text.append("\n  ").append(line);
  }
  return text;
}

}  // namespace

std::string PhysicsResult::text() const {
  std::string text;
  if (change) text += indented(model::to_text(*change));
  if (audit) text += indented(model::to_text(*audit));
  return text;
}

Physics::Physics(const Arguments& arguments, const model::BundleReader& bundle, const model::Cells& cells)
    : audit_(arguments.audit), conserve_(arguments.conserve) {
  check_cells(arguments, bundle, cells);
  check_fields(arguments, bundle);
  check_inputs(arguments, bundle);
  settings_ = model::audit_settings(furnace_of(arguments, bundle));
  mesh_ = bundle.mesh();
  schema_ = bundle.info().schema;
  usual_ = bundle.info().usual_audit;
  fields_ = field::keep_fields(bundle.info().fields, arguments.fields);
}

PhysicsResult Physics::apply(const field::CaseInputs& inputs, std::span<float> values) const {
  const model::CaseView view{
      .mesh = mesh_, .schema = schema_, .inputs = inputs.values, .fields = fields_, .values = values};
  PhysicsResult result;
  try {
    if (conserve_) result.change = model::conserve(view, values, {}, settings_);
  } catch (const NumericalError& error) {
    throw NumericalError("case " + inputs.name + ": " + error.what());
  }
  if (audit_) {
    result.audit = model::audit(view, settings_);
    result.audit->unusual = model::unusual_figures(*result.audit, usual_);
  }
  return result;
}

}  // namespace elrom::fields
