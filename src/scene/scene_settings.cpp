#include "elrom/scene/scene_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/csv.hpp"
#include "elrom/io/settings_table.hpp"

namespace elrom::scene {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double tiny = std::numeric_limits<double>::min();
constexpr double longest = 1e6;  // m, and s

io::SettingsTable<BoxSettings> box_table() {
  io::SettingsTable<BoxSettings> t;
  t.word(
       "name", "for sides and regions", [](auto& b) -> auto& { return b.name; })
      .require();
  t.vector(
       "low", "lowest corner", [](auto& b) -> auto& { return b.low; }, "m")
      .require();
  t.vector(
       "high", "highest corner", [](auto& b) -> auto& { return b.high; }, "m")
      .require();
  t.quantities(
      "top_low", "x, y of the top's low corner", [](auto& b) -> auto& { return b.top_low; }, "m", 2);
  t.quantities(
      "top_high", "x, y of the top's high corner", [](auto& b) -> auto& { return b.top_high; }, "m", 2);
  t.word("turn_axis", "turned about an axis", [](auto& b) -> auto& { return b.turn_axis; }, {"x", "y", "z"});
  t.quantity(
      "turn_angle", "by this angle, right-handed", [](auto& b) -> auto& { return b.turn_angle; }, "rad", -10,
      10);
  t.vector(
      "turn_about", "through this point", [](auto& b) -> auto& { return b.turn_about; }, "m");
  return t;
}

std::string box_fault(const BoxSettings& box) {
  return box.top_low.size() == box.top_high.size() ? "" : "both top_low and top_high";
}

io::SettingsTable<GroupSettings> group_table() {
  io::SettingsTable<GroupSettings> t;
  t.word(
       "group", "its name", [](auto& g) -> auto& { return g.group; })
      .require();
  t.word(
      "distribution", "of diameters", [](auto& g) -> auto& { return g.distribution; }, spread_names.names());
  t.quantity(
       "diameter", "mean", [](auto& g) -> auto& { return g.diameter; }, "m", 1e-9, 10)
      .require();
  t.quantity(
      "deviation", "standard deviation", [](auto& g) -> auto& { return g.deviation; }, "m", 0, 10);
  t.quantity(
      "smallest", "diameters below are drawn again", [](auto& g) -> auto& { return g.smallest; }, "m", 0, 10);
  t.quantity(
      "largest", "diameters above are drawn again", [](auto& g) -> auto& { return g.largest; }, "m", 0, 10);
  t.quantity(
      "density", "of the material", [](auto& g) -> auto& { return g.density; }, "kg/m3", 1e-3, 1e6);
  t.whole(
      "number", "of spheres", [](auto& g) -> auto& { return g.number; }, 0, 20'000'000);
  t.quantity(
      "mass", "instead of their number", [](auto& g) -> auto& { return g.mass; }, "kg", 0, 1e6);
  t.real(
      "parcels", "spheres that each parcel stands for", [](auto& g) -> auto& { return g.parcels; }, 1, 1e12);
  t.word(
      "region", "box or region where they begin", [](auto& g) -> auto& { return g.region; });
  t.word(
      "arrangement", "random, or a lattice for dense ones", [](auto& g) -> auto& { return g.arrangement; },
      arrangement_names.names());
  t.vector(
      "velocity", "at the beginning", [](auto& g) -> auto& { return g.velocity; }, "m/s");
  t.quantity(
      "scatter", "of each velocity component", [](auto& g) -> auto& { return g.scatter; }, "m/s", 0, 1e5);
  t.quantity(
      "over", "they come during this time", [](auto& g) -> auto& { return g.over; }, "s", 0, longest);
  return t;
}

std::string group_fault(const GroupSettings& group) {
  if (group.number.has_value() == group.mass.has_value()) return "either number or mass";
  if (group.distribution != "value" && group.deviation == 0) return "a deviation above 0";
  return group.smallest.value_or(0) <= group.diameter && group.diameter <= group.largest.value_or(unbounded)
             ? ""
             : "a diameter between smallest and largest";
}

io::SettingsTable<SectionSettings> section_table() {
  io::SettingsTable<SectionSettings> t;
  t.word(
       "name", "of its columns", [](auto& s) -> auto& { return s.name; })
      .require();
  t.vector(
       "low", "lowest corner", [](auto& s) -> auto& { return s.low; }, "m")
      .require();
  t.vector(
       "high", "highest corner", [](auto& s) -> auto& { return s.high; }, "m")
      .require();
  t.numbers(
      "cells", "in x, y, z", [](auto& s) -> auto& { return s.cells; },
      [](const std::vector<double>& v) {
        return v.size() == 3 &&
               std::ranges::all_of(v, [](double n) { return n >= 1 && n <= 1000 && n == std::floor(n); }) &&
               v[0] * v[1] * v[2] <= 1e5;
      },
      "three whole numbers from 1, with a product up to 100000");
  return t;
}

std::string section_fault(const SectionSettings& s) {
  return s.low.x < s.high.x && s.low.y < s.high.y && s.low.z < s.high.z ? "" : "low below high";
}

io::SettingsTable<GasInletSettings> gas_inlet_table() {
  io::SettingsTable<GasInletSettings> t;
  t.word(
       "side", "of a box", [](auto& s) -> auto& { return s.side; })
      .require();
  t.vector(
       "velocity", "superficial", [](auto& s) -> auto& { return s.velocity; }, "m/s")
      .require();
  return t;
}

using Table = io::SettingsTable<SceneSettings>;

void add_scene_rows(Table& t) {
  t.word(
      "scene.name", "for people", [](auto& s) -> auto& { return s.name; });
  t.quantity(
      "scene.duration", "simulated time", [](auto& s) -> auto& { return s.duration; }, "s", 0, longest);
  t.quantity(
      "scene.time_step", "of forces and output; collisions take their own",
      [](auto& s) -> auto& { return s.time_step; }, "s", 1e-12, longest);
  t.whole(
      "scene.seed", "of all that is random", [](auto& s) -> auto& { return s.seed; }, 0);
}

void add_domain_rows(Table& t) {
  t.words(
      "domain.outlets", "sides where spheres leave: \"box.z_high\"",
      [](auto& s) -> auto& { return s.outlets; });
  t.words(
      "domain.openings", "sides that boxes share", [](auto& s) -> auto& { return s.openings; });
  t.words(
      "domain.periodic", "directions", [](auto& s) -> auto& { return s.periodic; });
}

void add_gas_rows(Table& t) {
  t.word("gas.model", "what the spheres fly through", [](auto& s) -> auto& { return s.gas; },
         {"none", "uniform", "frozen", "coupled"});
  t.quantity(
      "gas.density", "", [](auto& s) -> auto& { return s.gas_properties.density; }, "kg/m3", 1e-9, 1e5);
  t.quantity(
      "gas.viscosity", "", [](auto& s) -> auto& { return s.gas_properties.viscosity; }, "Pa s", 1e-12, 1e3);
  t.vector(
      "gas.velocity", "of a uniform gas", [](auto& s) -> auto& { return s.gas_velocity; }, "m/s");
  t.word(
      "gas.file",
      "of a frozen gas: a prediction (.hdf), a case of OpenFOAM or the folder of a run with a coupled gas",
      [](auto& s) -> auto& { return s.gas_file; });
  t.vector(
      "grid.cell", "size of a cell: hel, coupled gas, drag that asks for the voidage",
      [](auto& s) -> auto& { return s.cell; }, "m");
}

void add_effect_rows(Table& t) {
  t.vector(
      "effects.gravity", "", [](auto& s) -> auto& { return s.gravity; }, "m/s2");
  t.flag(
      "effects.buoyancy", "", [](auto& s) -> auto& { return s.buoyancy; });
  auto drags = drag_names.names();
  drags.insert(drags.begin(), "none");
  t.word(
      "effects.drag", "", [](auto& s) -> auto& { return s.drag; }, drags);
  t.flag(
      "effects.rotation", "spheres spin", [](auto& s) -> auto& { return s.rotation; });
  t.word(
      "effects.walls", "", [](auto& s) -> auto& { return s.walls; }, wall_names.names());
  t.word(
      "effects.collisions", "", [](auto& s) -> auto& { return s.collisions; }, collision_names.names());
  t.word(
      "effects.recirculation", "region where spheres that left come back",
      [](auto& s) -> auto& { return s.recirculation; });
  t.vector(
      "effects.recirculation_velocity", "", [](auto& s) -> auto& { return s.recirculation_velocity; }, "m/s");
}

void add_collision_rows(Table& t) {
  t.real(
      "walls.normal_restitution", "", [](auto& s) -> auto& { return s.wall_law.normal_restitution; }, 0, 1);
  t.real(
      "walls.tangential_restitution", "", [](auto& s) -> auto& { return s.wall_law.tangential_restitution; },
      0, 1);
  t.word(
      "collisions.model", "of helscm: exact, or a file of elrom-train collisions",
      [](auto& s) -> auto& { return s.collision_model; });
  t.word(
      "collisions.law", "of a contact", [](auto& s) -> auto& { return s.law; }, particle::law_names.names());
  t.real(
      "collisions.restitution", "", [](auto& s) -> auto& { return s.contact.restitution; }, 0, 1);
  t.real(
      "collisions.friction", "asks for rotation", [](auto& s) -> auto& { return s.contact.friction; }, 0,
      100);
  t.quantity(
      "collisions.stiffness", "linear law", [](auto& s) -> auto& { return s.stiffness; }, "N/m", tiny, 1e12);
  t.quantity(
      "collisions.youngs_modulus", "hertz", [](auto& s) -> auto& { return s.contact.youngs_modulus; }, "Pa",
      tiny, 1e13);
  t.real(
      "collisions.poisson_ratio", "hertz", [](auto& s) -> auto& { return s.contact.poisson_ratio; }, -0.99,
      0.5);
  t.quantity(
      "collisions.contact_time", "of helscm: within it a second collision loses no energy",
      [](auto& s) -> auto& { return s.contact_time; }, "s", 0, longest);
  t.whole(
      "collisions.steps_per_contact", "of dem", [](auto& s) -> auto& { return s.steps_per_contact; }, 10,
      10000);
}

void add_granular_rows(Table& t) {
  t.real(
      "granular.packing", "of hel: the largest fraction of solids",
      [](auto& s) -> auto& { return s.granular.packing; }, 0.1, 1);
  t.real(
      "granular.friction_from", "fraction from which solids rub",
      [](auto& s) -> auto& { return s.granular.friction_from; }, 0.05, 1);
  t.quantity(
      "granular.friction_angle", "", [](auto& s) -> auto& { return s.granular.friction_angle; }, "rad", 0,
      1.5);
  t.flag(
      "granular.damping", "collisions even out velocities within a cell",
      [](auto& s) -> auto& { return s.granular.damping; });
  t.word(
      "granular.radial", "distribution", [](auto& s) -> auto& { return s.radial; },
      particle::radial_names.names());
  t.word(
      "granular.viscosity", "of flight", [](auto& s) -> auto& { return s.viscosity; },
      particle::flight_viscosity_names.names());
}

void add_output_rows(Table& t) {
  t.quantity(
      "output.every", "simulated time between outputs", [](auto& s) -> auto& { return s.output_every; }, "s",
      0, longest);
  t.quantity(
      "output.checkpoint_every", "simulated time between checkpoints",
      [](auto& s) -> auto& { return s.checkpoint_every; }, "s", 0, longest);
  t.words(
      "output.formats", "vtp, or nothing", [](auto& s) -> auto& { return s.formats; });
}

Table make_table() {
  Table t;
  add_scene_rows(t);
  add_domain_rows(t);
  add_gas_rows(t);
  add_effect_rows(t);
  add_collision_rows(t);
  add_granular_rows(t);
  add_output_rows(t);
  t.tables(
      "domain.boxes", "a union of boxes", [](auto& s) -> auto& { return s.boxes; }, box_table(), box_fault);
  t.tables(
      "gas.inlets", "sides where a coupled gas comes in", [](auto& s) -> auto& { return s.gas_inlets; },
      gas_inlet_table());
  t.tables(
      "regions", "where spheres begin and come back", [](auto& s) -> auto& { return s.regions; }, box_table(),
      box_fault);
  t.tables(
      "particles", "groups of spheres", [](auto& s) -> auto& { return s.groups; }, group_table(),
      group_fault);
  t.tables(
      "probes.sections", "sums over cells of a box", [](auto& s) -> auto& { return s.sections; },
      section_table(), section_fault);
  return t;
}

const Table& table() {
  static const auto made = make_table();
  return made;
}

void expect(bool holds, const std::string& where, const char* what, const char* expected) {
  if (!holds) throw UsageError(Problem{.what = what, .where = where, .expected = expected});
}

// What no single key tells.
void expect_fits(const SceneSettings& s, const std::string& where) {
  expect(s.time_step > 0, where, "missing setting 'scene.time_step'", "a time step");
  expect(!s.groups.empty(), where, "missing setting 'particles'", "[[particles]] tables");
  expect(s.duration / s.time_step <= 1e12, where, "too many time steps", "at most 1e12");
  expect(s.contact.friction == 0 || s.rotation, where, "collisions.friction without rotation",
         "effects.rotation = true");
  expect(s.drag == "none" || s.gas != "none", where, "effects.drag without a gas",
         "gas.model = \"uniform\", \"frozen\" or \"coupled\"");
  expect(!s.buoyancy || s.gas != "none", where, "effects.buoyancy without a gas",
         "gas.model = \"uniform\", \"frozen\" or \"coupled\"");
  expect(s.gas != "frozen" || !s.gas_file.empty(), where, "a frozen gas without gas.file",
         "a prediction (.hdf)");
  expect(s.walls != "dem" || s.collisions == "dem", where, "effects.walls = \"dem\" without soft spheres",
         "effects.collisions = \"dem\"");
  expect(!s.needs_grid() || (s.cell.x > 0 && s.cell.y > 0 && s.cell.z > 0), where,
         "missing setting 'grid.cell'", "the size of a cell");
  expect(s.granular.friction_from < s.granular.packing, where, "granular.friction_from",
         "less than granular.packing");
  expect(!s.has_parcels() || (s.collisions != "dem" && s.collisions != "helscm_document"), where,
         "parcels in a collision model of single spheres", "effects.collisions = \"hel\" or \"helscm\"");
  expect(s.gas != "coupled" || s.drag != "none", where, "a coupled gas without effects.drag", "a drag law");
  expect(s.gas_inlets.empty() || s.gas == "coupled", where, "gas.inlets without a coupled gas",
         "gas.model = \"coupled\"");
  expect(s.recirculation.empty() || !s.outlets.empty(), where, "effects.recirculation without outlets",
         "domain.outlets");
  for (const auto& format : s.formats) expect(format == "vtp", where, "unknown output format", "vtp");
}

}  // namespace

Body BoxSettings::body() const {
  BoxShape shape{.name = name,
                 .low = low,
                 .high = high,
                 .turn_axis = turn_axis[0],
                 .turn_angle = turn_angle,
                 .turn_about = turn_about};
  if (top_low.size() == 2 && top_high.size() == 2)
    shape.top = {{{top_low[0], top_low[1]}, {top_high[0], top_high[1]}}};
  return body_of(shape);
}

bool SceneSettings::has_parcels() const {
  return std::ranges::any_of(groups, [](const GroupSettings& g) { return g.parcels > 1; });
}

bool SceneSettings::needs_grid() const {
  const bool knows_voidage = drag != "none" && particle::needs_voidage(drag_names.value<UsageError>(drag));
  return gas == "coupled" || collisions == "hel" || knows_voidage;
}

Domain SceneSettings::domain() const {
  std::vector<Body> bodies;
  for (const auto& box : boxes) bodies.push_back(box.body());
  return Domain(std::move(bodies), outlets, openings, periodic);
}

std::int64_t SceneSettings::n_steps() const {
  return static_cast<std::int64_t>(std::llround(duration / time_step));
}

std::int64_t SceneSettings::steps_in(double every) const {
  return std::max<std::int64_t>(1, every > 0 ? std::llround(every / time_step) : n_steps());
}

SceneSettings parse_scene(std::string_view text, const std::string& where,
                          const std::vector<std::string>& overrides) {
  SceneSettings scene;
  table().read(scene, io::parse_settings(text, where));
  for (const auto& change : overrides) table().read(scene, io::parse_override(change));
  expect_fits(scene, where);
  return scene;
}

SceneSettings read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  auto scene = parse_scene(io::read_small_text(file), file.string(), overrides);
  scene.folder = file.parent_path();
  return scene;
}

std::string to_toml(const SceneSettings& scene) { return table().write(scene); }

std::string scene_help() {
  std::string text;
  for (const auto& row : table().rows()) text += fmt::format("  {:<34}{}\n", row.key, row.meaning);
  return text;
}

}  // namespace elrom::scene
