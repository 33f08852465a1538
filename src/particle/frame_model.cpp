#include "elrom/particle/frame_model.hpp"

#include <array>
#include <cmath>

#include "elrom/base/error.hpp"
#include "impact.hpp"

namespace elrom::particle {
namespace {

constexpr std::size_t pairs_at_once = 256;  // pairs, a multiple of every lane width

// Dimensionless speed a speed: sqrt(m12 / (K R^(p-1))) / R.
class SpeedScale {
 public:
  explicit SpeedScale(const ContactLaw& law)
      : hertz_(law.kind == LawKind::hertz),
        // PairContact's stiffness of spheres with R* = 1.
        stiffness_(PairContact(law, {4, 1}, {4, 1}).stiffness) {}

  [[nodiscard]] Lane of(const Impact& impact) const {
    const Lane distance = impact.radius_1 + impact.radius_2;
    Lane stiffness = stiffness_;
    if (hertz_) stiffness *= sqrt(impact.radius_1 * impact.radius_2);  // sqrt(R*) sqrt(R)
    return sqrt(impact.reduced_mass / stiffness) / distance;
  }

 private:
  bool hertz_;
  double stiffness_;
};

constexpr double widest_orbit = 4;  // of slow pairs on fast orbits; what they exchange is small

// Inputs of the regressor, and what turns its outputs into impulses.
struct Features {
  Lane speed;         // U, m/s
  LaneVector beside;  // n x slip
  Lane angle, dimensionless;
  Lane orbit[3];
};

Lane bounded(const Lane& value) { return min(max(value, Lane(-widest_orbit)), Lane(widest_orbit)); }

Features features_of(const Impact& impact, const SpeedScale& scale, bool with_spins) {
  Features f;
  f.speed = sqrt(impact.normal_speed * impact.normal_speed + impact.slip_speed * impact.slip_speed);
  f.beside = cross(impact.normal, impact.slip);
  f.angle = impact.slip_speed / (impact.normal_speed + impact.slip_speed);
  f.dimensionless = sqrt(f.speed * scale.of(impact));
  if (with_spins) {
    f.orbit[0] = bounded(dot(impact.velocity, impact.slip) / f.speed);
    f.orbit[1] = bounded(dot(impact.velocity, f.beside) / f.speed);
    f.orbit[2] = bounded(dot(impact.spin, impact.normal) / f.speed);
  }
  return f;
}

void store_features(const Impact& impact, const Features& f, bool with_spins, Table& inputs, std::size_t at) {
  const auto put = [&](const Lane& value, std::size_t column) {
    store(select(impact.closing, value, Lane(0.0)), inputs, at, column);
  };
  put(f.angle, 0);
  put(f.dimensionless, 1);
  for (std::size_t k = 0; with_spins && k < 3; ++k) put(f.orbit[k], 2 + k);
}

struct Sizes {
  std::size_t inputs, outputs;
};
constexpr Sizes sizes_of(bool with_spins) { return with_spins ? Sizes{5, 5} : Sizes{2, 3}; }

Table table(std::size_t rows, std::size_t columns) {
  return Table::Zero(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
}

// What turned sphere 2, divided by r2: (2/5) m2 r2 (w2' - w2).
Components moments(const Pairs& pairs, const Motion& after) {
  const Scalars factor =
      0.2 * sphere_mass(1, 1) * pairs.density_2 * pairs.diameter_2.cube() * pairs.diameter_2;
  return (after.spin_2 - pairs.before.spin_2).colwise() * factor;
}

Components change_of_momentum(const Pairs& pairs, const Motion& after) {
  const Scalars mass = sphere_mass(1, 1) * pairs.density_2 * pairs.diameter_2.cube();
  return (after.velocity_2 - pairs.before.velocity_2).colwise() * mass;
}

}  // namespace

FrameRecords frame_records(const Pairs& pairs, const Motion& after, const ContactLaw& law, bool with_spins) {
  const auto sizes = sizes_of(with_spins);
  FrameRecords records{table(pairs.size(), sizes.inputs), table(pairs.size(), sizes.outputs),
                       Scalars(static_cast<Eigen::Index>(pairs.size()))};
  const Components impulse = change_of_momentum(pairs, after), moment = moments(pairs, after);
  const SpeedScale scale(law);
  for (std::size_t first = 0; first < pairs.size(); first += lane_width) {
    const auto impact = impact_of(pairs, first);
    check(all_of(impact.closing), "frame_records: pairs that close in");
    const auto f = features_of(impact, scale, with_spins);
    store_features(impact, f, with_spins, records.inputs, first);
    store(f.speed, records.speed, first);
    const Lane per_unit = 1 / (impact.reduced_mass * f.speed);
    const LaneVector given = per_unit * load_vector(impulse, first),
                     turned = per_unit * load_vector(moment, first);
    store(dot(given, impact.normal), records.targets, first, 0);
    store(-dot(given, impact.slip), records.targets, first, 1);
    store(dot(turned, f.beside), records.targets, first, 2);
    if (!with_spins) continue;
    store(dot(given, f.beside), records.targets, first, 3);
    store(dot(turned, impact.slip), records.targets, first, 4);
  }
  return records;
}

FrameModel::FrameModel(const ContactLaw& law, std::shared_ptr<const Regressor> regressor,
                       double greatest_speed)
    : law_(law), regressor_(std::move(regressor)), greatest_speed_(greatest_speed) {
  law_.check();
  const auto fits = [&](const Sizes& sizes) {
    return regressor_->n_inputs() == sizes.inputs && regressor_->n_outputs() == sizes.outputs;
  };
  if (!fits(sizes_of(false)) && !fits(sizes_of(true)))
    throw InputError(Problem{.what = "a regressor of another size in a frame surrogate",
                             .found = std::to_string(regressor_->n_inputs()) + " inputs, " +
                                      std::to_string(regressor_->n_outputs()) + " outputs",
                             .expected = "2 and 3, or 5 and 5"});
  if (!(greatest_speed_ > 0 && std::isfinite(greatest_speed_)))
    throw InputError(Problem{.what = "wrong greatest speed of a frame surrogate",
                             .found = std::to_string(greatest_speed_),
                             .expected = "more than 0"});
}

void FrameModel::impulses(const Pairs& pairs, Impulses& impulses) const {
  impulses.resize(pairs.size());
  const bool with_spins = regressor_->n_inputs() == sizes_of(true).inputs;
  const SpeedScale scale(law_);
  Table inputs = table(pairs_at_once, regressor_->n_inputs()),
        outputs = table(pairs_at_once, regressor_->n_outputs());
  std::array<Impact, pairs_at_once / lane_width> impacts;
  std::array<Features, pairs_at_once / lane_width> features;
  for (std::size_t begin = 0; begin < pairs.size(); begin += pairs_at_once) {
    const auto count = (std::min(pairs_at_once, pairs.size() - begin) + lane_width - 1) / lane_width;
    for (std::size_t k = 0; k < count; ++k) {
      impacts[k] = impact_of(pairs, begin + k * lane_width);
      features[k] = features_of(impacts[k], scale, with_spins);
      features[k].dimensionless = min(features[k].dimensionless, Lane(greatest_speed_));
      store_features(impacts[k], features[k], with_spins, inputs, k * lane_width);
    }
    const auto n = static_cast<Eigen::Index>(count * lane_width);
    regressor_->evaluate(inputs.topRows(n), outputs.topRows(n));
    for (std::size_t k = 0; k < count; ++k) {
      const auto output = [&](std::size_t column) { return load(outputs, k * lane_width, column); };
      const auto& impact = impacts[k];
      const auto& f = features[k];
      const Lane unit = impact.reduced_mass * f.speed;
      Exchange exchange{output(0) * impact.normal - output(1) * impact.slip, output(2) * f.beside};
      if (with_spins) {
        exchange.impulse += output(3) * f.beside;
        exchange.moment += output(4) * impact.slip;
      }
      give(impact, {unit * exchange.impulse, (law_.friction > 0 ? unit : Lane(0.0)) * exchange.moment},
           impulses, begin + k * lane_width);
    }
  }
}

void FrameModel::write(io::TensorFile& file) const {
  const std::array speed{greatest_speed_};
  file.set("frame/greatest_speed", io::Tensor::copy(speed, {1}));
  regressor_->write(file, "frame/regressor");
}

std::unique_ptr<FrameModel> FrameModel::read(const io::TensorFile& file, const ContactLaw& law) {
  const auto speed = file.tensor("frame/greatest_speed", std::array<std::size_t, 1>{1}).f64();
  return std::make_unique<FrameModel>(law, read_regressor(file, "frame/regressor"), speed[0]);
}

}  // namespace elrom::particle
