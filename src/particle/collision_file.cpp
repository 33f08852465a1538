// The file collisions.h5 (data/FORMATS.md, kind "elrom-collisions").
#include <charconv>
#include <cmath>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/particle/collision_set.hpp"

namespace elrom::particle {
namespace {

using RowMajor = Eigen::Array<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Speeds are drawn, and so are almost noise: the lowest level packs them as well as the highest.
constexpr int level = 1;

void write(const io::Hdf5Group& group, const std::string& name, std::span<const double> values,
           const io::Shape& shape, std::string_view unit) {
  group.write<double>(name, values, shape, io::Hdf5Storage::packed(shape, level)).set_text("unit", unit);
}

void write(const io::Hdf5Group& group, const std::string& name, const Components& values,
           std::string_view unit) {
  const RowMajor rows = values;
  write(group, name, {rows.data(), static_cast<std::size_t>(rows.size())},
        {static_cast<std::size_t>(rows.rows()), 3}, unit);
}

void write(const io::Hdf5Group& group, const std::string& name, const Scalars& values,
           std::string_view unit) {
  const auto n = static_cast<std::size_t>(values.size());
  write(group, name, {values.data(), n}, {n}, unit);
}

void write(const io::Hdf5Group& group, const Motion& motion) {
  write(group, "velocity_1", motion.velocity_1, "m/s");
  write(group, "velocity_2", motion.velocity_2, "m/s");
  write(group, "spin_1", motion.spin_1, "rad/s");
  write(group, "spin_2", motion.spin_2, "rad/s");
}

void write(const io::Hdf5Group& group, const Protocol& protocol) {
  const auto range = [&](const std::string& name, const Range& value) {
    group.set_number(name + "_low", value.low);
    group.set_number(name + "_high", value.high);
  };
  group.set_text("name", protocol_names.name(protocol.kind));
  range("speed", protocol.speed);
  range("diameter_1", protocol.diameter_1);
  range("diameter_2", protocol.diameter_2);
  group.set_number("density_1", protocol.density_1);
  group.set_number("density_2", protocol.density_2);
  group.set_number("spin_speed", protocol.spin_speed);
  if (protocol.approach_time) group.set_number("approach_time", *protocol.approach_time);
}

void write(const io::Hdf5Group& group, const ContactLaw& law) {
  group.set_text("name", law_names.name(law.kind));
  group.set_number("restitution", law.restitution);
  group.set_number("friction", law.friction);
  if (law.tangential_restitution) group.set_number("tangential_restitution", *law.tangential_restitution);
  if (law.kind == LawKind::linear) {
    group.set_number("stiffness", law.stiffness);
  } else {
    group.set_number("youngs_modulus", law.youngs_modulus);
    group.set_number("poisson_ratio", law.poisson_ratio);
  }
}

/// Names and values side by side, which attributes of free names could not be: the library's reader of
/// attributes does not list them.
void write_provenance(const io::Hdf5Group& file, const std::map<std::string, std::string>& provenance) {
  if (provenance.empty()) return;
  std::vector<std::string> names, values;
  for (const auto& [name, value] : provenance) {
    names.push_back(name);
    values.push_back(value);
  }
  file.set_texts("provenance_names", names);
  file.set_texts("provenance", values);
}

void expect(bool holds, const io::Hdf5Object& object, const char* what, const std::string& found = {},
            const char* expected = "") {
  if (!holds) throw InputError({.what = what, .where = object.where(), .found = found, .expected = expected});
}

/// The first value that does not hold, by its number.
template <class Holds>
void expect_each(const Eigen::Ref<const Scalars>& values, const io::Hdf5Dataset& dataset, const char* what,
                 const Holds& holds) {
  for (Eigen::Index i = 0; i < values.size(); ++i)
    expect(holds(values[i]), dataset, what, base::number(values[i]) + " as number " + std::to_string(i + 1));
}

bool finite(double value) { return std::isfinite(value); }
bool positive(double value) { return value > 0; }
bool no_less_than_zero(double value) { return value >= 0; }

Components read_components(const io::Hdf5Group& group, const std::string& name, std::size_t n) {
  const auto dataset = group.dataset(name);
  dataset.expect_shape({n, 3});
  const auto values = dataset.read<double>();
  const Components result =
      Eigen::Map<const RowMajor>(values.data(), static_cast<Eigen::Index>(n), Eigen::Index{3});
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    expect_each(result.col(axis), dataset, "a value that is not finite", finite);
  return result;
}

template <class Holds>
Scalars read_scalars(const io::Hdf5Group& group, const std::string& name, std::size_t n, const char* what,
                     const Holds& holds) {
  const auto dataset = group.dataset(name);
  dataset.expect_shape({n});
  const auto values = dataset.read<double>();
  const Scalars result = Eigen::Map<const Scalars>(values.data(), static_cast<Eigen::Index>(n));
  expect_each(result, dataset, "a value that is not finite", finite);
  expect_each(result, dataset, what, holds);
  return result;
}

Motion read_motion(const io::Hdf5Group& group, std::size_t n) {
  Motion motion;
  motion.velocity_1 = read_components(group, "velocity_1", n);
  motion.velocity_2 = read_components(group, "velocity_2", n);
  motion.spin_1 = read_components(group, "spin_1", n);
  motion.spin_2 = read_components(group, "spin_2", n);
  return motion;
}

Components read_normals(const io::Hdf5Group& group, std::size_t n) {
  constexpr double most_deviation = 1e-9;
  const auto normal = read_components(group, "normal", n);
  const Scalars length = normal.square().rowwise().sum().sqrt();
  expect_each(length, group.dataset("normal"), "a normal that is no unit vector",
              [](double value) { return std::abs(value - 1) <= most_deviation; });
  return normal;
}

/// Sizes and densities that are fine each may still give no mass.
void expect_masses(const io::Hdf5Group& group, const Scalars& diameter, const Scalars& density) {
  for (Eigen::Index i = 0; i < diameter.size(); ++i) {
    const double mass = sphere_mass(diameter[i], density[i]);
    expect(std::isnormal(mass), group, "a sphere of no finite mass",
           base::number(mass) + " kg as number " + std::to_string(i + 1));
  }
}

Pairs read_pairs(const io::Hdf5Group& group) {
  const auto shape = group.dataset("diameter_1").shape();
  expect(shape.size() == 1 && shape[0] > 0, group.dataset("diameter_1"), "no row of pairs",
         io::text_of(shape));
  const auto n = shape[0];
  const auto more_than_zero = [&](const char* name) {
    return read_scalars(group, name, n, "a value that is not positive", positive);
  };
  Pairs pairs;
  pairs.diameter_1 = more_than_zero("diameter_1");
  pairs.diameter_2 = more_than_zero("diameter_2");
  pairs.density_1 = more_than_zero("density_1");
  pairs.density_2 = more_than_zero("density_2");
  expect_masses(group, pairs.diameter_1, pairs.density_1);
  expect_masses(group, pairs.diameter_2, pairs.density_2);
  pairs.overlap = read_scalars(group, "overlap", n, "a negative overlap", no_less_than_zero);
  pairs.normal = read_normals(group, n);
  return pairs;
}

template <class Names>
auto read_name(const Names& names, const io::Hdf5Group& group) {
  const auto name = group.text("name");
  if (const auto found = names.find(name)) return *found;
  throw InputError({.what = "unknown " + std::string(names.what),
                    .where = group.where(),
                    .found = "'" + name + "'",
                    .advice = base::name_advice(name, names.names())});
}

std::optional<double> read_optional(const io::Hdf5Object& object, const std::string& name) {
  return object.has_attribute(name) ? std::optional(object.number(name)) : std::nullopt;
}

/// What no user could ask for, no file may hold.
template <class T>
T checked(const T& value, const io::Hdf5Group& group) {
  try {
    value.check();
  } catch (const UsageError& error) {
    throw InputError({.what = error.what(), .where = group.where()});
  }
  return value;
}

Protocol read_protocol(const io::Hdf5Group& group) {
  const auto range = [&](const std::string& name) {
    return Range{group.number(name + "_low"), group.number(name + "_high")};
  };
  return checked(Protocol{.kind = read_name(protocol_names, group),
                          .speed = range("speed"),
                          .diameter_1 = range("diameter_1"),
                          .diameter_2 = range("diameter_2"),
                          .density_1 = group.number("density_1"),
                          .density_2 = group.number("density_2"),
                          .spin_speed = group.number("spin_speed"),
                          .approach_time = read_optional(group, "approach_time")},
                 group);
}

ContactLaw read_law(const io::Hdf5Group& group) {
  ContactLaw law{.kind = read_name(law_names, group),
                 .restitution = group.number("restitution"),
                 .friction = group.number("friction"),
                 .tangential_restitution = read_optional(group, "tangential_restitution")};
  if (law.kind == LawKind::linear) {
    law.stiffness = group.number("stiffness");
  } else {
    law.youngs_modulus = group.number("youngs_modulus");
    law.poisson_ratio = group.number("poisson_ratio");
  }
  return checked(law, group);
}

/// A text, since a number would lose digits of a large one.
std::uint64_t read_seed(const io::Hdf5Group& file) {
  const auto text = file.text("seed");
  std::uint64_t seed = 0;
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), seed);
  expect(fault == std::errc{} && stop == text.data() + text.size(), file, "the seed is no whole number",
         "'" + text + "'");
  return seed;
}

std::map<std::string, std::string> read_provenance(const io::Hdf5Group& file) {
  std::map<std::string, std::string> provenance;
  if (!file.has_attribute("provenance")) return provenance;
  const auto names = file.texts("provenance_names"), values = file.texts("provenance");
  expect(names.size() == values.size(), file, "provenance_names and provenance differ in size");
  for (std::size_t i = 0; i < names.size(); ++i) provenance[names[i]] = values[i];
  return provenance;
}

Parting read_parting(const io::Hdf5Group& file, std::size_t n) {
  const auto contact = file.group("contact");
  Parting parting;
  parting.after = read_motion(file.group("after"), n);
  parting.overlap = read_scalars(contact, "overlap", n, "a negative overlap", no_less_than_zero);
  parting.duration = read_scalars(contact, "duration", n, "a negative duration", no_less_than_zero);
  const double n_stayed = contact.number("stayed");
  expect(n_stayed >= 0 && n_stayed <= static_cast<double>(n), contact,
         "a number of pairs that stayed together", base::number(n_stayed), "0 to the number of pairs");
  parting.n_stayed = static_cast<std::size_t>(n_stayed);
  parting.pair_steps = contact.number("steps");
  expect(parting.pair_steps >= 0 && finite(parting.pair_steps), contact, "a number of steps",
         base::number(parting.pair_steps));
  return parting;
}

CollisionSet read_set(const std::filesystem::path& path) {
  const auto file = io::Hdf5File::open(path);
  io::check_kind(file, io::kinds::collisions);
  CollisionSet set;
  set.protocol = read_protocol(file.group("protocol"));
  set.law = read_law(file.group("law"));
  set.seed = read_seed(file);
  set.speed_cap = read_optional(file, "speed_cap");
  expect(!set.speed_cap || (positive(*set.speed_cap) && finite(*set.speed_cap)), file, "a wrong speed cap",
         base::number(set.speed_cap.value_or(0)), "more than 0 m/s");
  set.provenance = read_provenance(file);
  set.pairs = read_pairs(file.group("pair"));
  set.pairs.before = read_motion(file.group("before"), set.size());
  set.parting = read_parting(file, set.size());
  return set;
}

}  // namespace

void write_collisions(const std::filesystem::path& path, const CollisionSet& set) {
  base::AtomicFile target(path);
  auto file = io::Hdf5File::create(target.temporary());
  io::write_kind(file, io::kinds::collisions);
  file.set_text("seed", std::to_string(set.seed));
  if (set.speed_cap) file.set_number("speed_cap", *set.speed_cap);
  write_provenance(file, set.provenance);
  write(file.create_group("protocol"), set.protocol);
  write(file.create_group("law"), set.law);
  write(file.create_group("before"), set.pairs.before);
  write(file.create_group("after"), set.parting.after);
  const auto pair = file.create_group("pair");
  write(pair, "normal", set.pairs.normal, "1");
  write(pair, "diameter_1", set.pairs.diameter_1, "m");
  write(pair, "diameter_2", set.pairs.diameter_2, "m");
  write(pair, "density_1", set.pairs.density_1, "kg/m3");
  write(pair, "density_2", set.pairs.density_2, "kg/m3");
  write(pair, "overlap", set.pairs.overlap, "m");
  const auto contact = file.create_group("contact");
  write(contact, "overlap", set.parting.overlap, "m");
  write(contact, "duration", set.parting.duration, "s");
  contact.set_integer("stayed", static_cast<std::int64_t>(set.parting.n_stayed));
  contact.set_number("steps", set.parting.pair_steps);
  file.close();
  target.commit();
}

CollisionSet read_collisions(const std::filesystem::path& path) {
  io::survive(path, "collisions", [&] { static_cast<void>(read_set(path)); });
  return read_set(path);
}

}  // namespace elrom::particle
