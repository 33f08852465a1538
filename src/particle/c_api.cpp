// No exception leaves this file: each becomes a status and a line of text kept for the calling thread.
#include <algorithm>
#include <cmath>

#include "elrom/base/c_interface.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/particle/collision.h"
#include "elrom/particle/collision_model.hpp"

using elrom::particle::Components;
using elrom::particle::Impulses;
using elrom::particle::Pairs;
using elrom::particle::Scalars;

struct elrom_collision {
  elrom::particle::CollisionBundle bundle;
  std::string text;
};

namespace {

using Index = Eigen::Index;

/// The caller's arrays.
struct Arrays {
  const double *velocity_1, *velocity_2, *spin_1, *spin_2, *normal, *diameter_1, *diameter_2, *density_1,
      *density_2;
  double *linear_1, *linear_2, *angular_1, *angular_2;
};

void expect_sound(std::size_t n, const Arrays& arrays) {
  constexpr double most_deviation = 1e-6;  // of the normal's length squared
  const auto refuse = [](const char* what, double found, std::size_t i) {
    throw elrom::InputError({.what = what,
                             .where = "pair " + std::to_string(i) + ", counted from 0",
                             .found = elrom::base::number(found)});
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (const auto* sizes : {arrays.diameter_1, arrays.diameter_2})
      if (!(sizes[i] > 0 && sizes[i] < HUGE_VAL)) refuse("no diameter", sizes[i], i);
    for (const auto* densities : {arrays.density_1, arrays.density_2})
      if (!(densities[i] > 0 && densities[i] < HUGE_VAL)) refuse("no density", densities[i], i);
    const auto* normal = arrays.normal + 3 * i;
    const double square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    if (!(std::abs(square - 1) <= most_deviation)) refuse("no unit normal; its length", std::sqrt(square), i);
  }
}

/// So many pairs go through the model at once: they stay in the cache.
constexpr std::size_t portion = 1024;

/// Memory of one thread, kept between its calls.
class Scratch {
 public:
  void run(const elrom::particle::CollisionModel& model, std::size_t first, std::size_t n,
           const Arrays& arrays) {
    if (pairs_.size() != n) {
      pairs_ = Pairs(n);
      impulses_ = Impulses(n);
    }
    take(arrays.velocity_1, first, pairs_.before.velocity_1);
    take(arrays.velocity_2, first, pairs_.before.velocity_2);
    take(arrays.spin_1, first, pairs_.before.spin_1);
    take(arrays.spin_2, first, pairs_.before.spin_2);
    take(arrays.normal, first, pairs_.normal);
    take(arrays.diameter_1, first, pairs_.diameter_1);
    take(arrays.diameter_2, first, pairs_.diameter_2);
    take(arrays.density_1, first, pairs_.density_1);
    take(arrays.density_2, first, pairs_.density_2);
    model.impulses(pairs_, impulses_);
    give(impulses_.linear_1, first, arrays.linear_1);
    give(impulses_.linear_2, first, arrays.linear_2);
    give(impulses_.angular_1, first, arrays.angular_1);
    give(impulses_.angular_2, first, arrays.angular_2);
  }

 private:
  using Rows = Eigen::Array<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

  static void take(const double* from, std::size_t first, Components& to) {
    if (from == nullptr)
      to.setZero();
    else
      to = Eigen::Map<const Rows>(from + 3 * first, to.rows(), Index{3});
  }
  static void take(const double* from, std::size_t first, Scalars& to) {
    std::copy_n(from + first, to.size(), to.data());
  }
  static void give(const Components& from, std::size_t first, double* to) {
    if (to != nullptr) Eigen::Map<Rows>(to + 3 * first, from.rows(), Index{3}) = from;
  }

  Pairs pairs_;
  Impulses impulses_;
};

}  // namespace

const char* elrom_collision_last_error(void) { return elrom::base::c_last_error.c_str(); }

elrom_collision* elrom_collision_open(const char* path) {
  elrom_collision* opened = nullptr;
  elrom::base::c_guarded([&] {
    elrom::base::c_need(path != nullptr, "path");
    auto bundle = elrom::particle::CollisionBundle::read(path);
    auto text = bundle.model->text();
    opened = new elrom_collision{std::move(bundle), std::move(text)};
  });
  return opened;
}

void elrom_collision_close(elrom_collision* model) { delete model; }

const char* elrom_collision_text(const elrom_collision* model) {
  return model == nullptr ? nullptr : model->text.c_str();
}

int elrom_collision_impulses(const elrom_collision* model, size_t n, const double* velocity_1,
                             const double* velocity_2, const double* spin_1, const double* spin_2,
                             const double* normal, const double* diameter_1, const double* diameter_2,
                             const double* density_1, const double* density_2, double* linear_1,
                             double* linear_2, double* angular_1, double* angular_2) {
  return elrom::base::c_guarded([&] {
    elrom::base::c_need(model != nullptr, "model");
    if (n == 0) return;
    const Arrays arrays{velocity_1, velocity_2, spin_1,   spin_2,   normal,    diameter_1, diameter_2,
                        density_1,  density_2,  linear_1, linear_2, angular_1, angular_2};
    elrom::base::c_need(velocity_1 != nullptr && velocity_2 != nullptr, "velocity_1 or velocity_2");
    elrom::base::c_need(normal != nullptr, "normal");
    elrom::base::c_need(diameter_1 != nullptr && diameter_2 != nullptr, "diameter_1 or diameter_2");
    elrom::base::c_need(density_1 != nullptr && density_2 != nullptr, "density_1 or density_2");
    elrom::base::c_need(linear_1 != nullptr && linear_2 != nullptr, "linear_1 or linear_2");
    expect_sound(n, arrays);
    thread_local Scratch scratch;
    for (std::size_t first = 0; first < n; first += portion)
      scratch.run(*model->bundle.model, first, std::min(portion, n - first), arrays);
  });
}
