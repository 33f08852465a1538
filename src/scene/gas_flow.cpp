#include "elrom/scene/gas_flow.hpp"

#include <algorithm>
#include <cmath>

#include "cell_equation.hpp"
#include "elrom/base/error.hpp"

namespace elrom::scene {
namespace {

constexpr double tolerance = 1e-9;  // of the pressure's equation
constexpr double courant = 4;       // cells that the gas crosses in a step at most, for accuracy
constexpr int most_sweeps = 30;     // of the velocities' equation,
constexpr double enough = 1e-7;     // or until they change by so little
constexpr std::int32_t none = CellGrid::none;

}  // namespace

// A face of an open cell, with all that its equation reads. A wall is an inlet that lets nothing in.
struct GasFlow::Face {
  enum class Kind : std::uint8_t { inside, inlet, outlet, wall };
  Kind kind;
  std::size_t axis, number;
  std::int32_t low, high;                             // cells; none: outside
  std::array<std::int32_t, 2> along;                  // faces before and behind, or none
  std::array<std::array<std::int32_t, 2>, 3> beside;  // faces along the other axes, or none: a wall,
  std::array<std::array<double, 2>, 3> wall;          // which moves so fast
  std::array<std::array<std::int32_t, 4>, 3> cross;   // faces across the other axes
  double inflow = 0;                                  // of an inlet: superficial, along the axis, m/s

  [[nodiscard]] bool is_given() const { return kind == Kind::inlet || kind == Kind::wall; }  // its velocity
  [[nodiscard]] std::size_t inner() const { return static_cast<std::size_t>(low == none ? high : low); }
};

struct GasFlow::Equation {
  CellEquation equation;
  std::unique_ptr<CellSolver> solver;
};

GasFlow::GasFlow(const Domain& domain, std::shared_ptr<CellGrid> grid, const particle::Gas& gas,
                 const std::vector<GasInlet>& inlets, const Vec& force)
    : grid_(std::move(grid)),
      gas_(gas),
      force_(array_of(force)),
      pressure_(grid_->size()),
      mean_pressure_(grid_->size()),
      correction_(grid_->size()) {
  for (std::size_t a = 0; a < 3; ++a)
    velocity_[a].assign(grid_->face_count(a), 0), mean_[a] = before_[a] = hold_[a] = flux_[a] = velocity_[a];
  find_faces(domain, inlets);
  scale_inlets(domain, inlets);
  held_.assign(static_cast<std::size_t>(std::ranges::count_if(faces_, &Face::is_given)), 0);
  equation_ = std::make_unique<Equation>(Equation{CellEquation(*grid_), make_eigen_solver(*grid_)});
}
GasFlow::~GasFlow() = default;

namespace {

// What lies behind a side of a cell that is open, where no open cell does.
struct Beyond {
  bool is_outlet = false;
  const GasInlet* inlet = nullptr;
};

Beyond beyond(const Domain& domain, const std::vector<GasInlet>& inlets, const Vec& inside,
              const Vec& outside) {
  // The side of the body that the way out passes first.
  const auto exit = domain.first_exit(inside, outside - inside, 0, 1.5);
  if (exit.side == nullptr) return {};
  if (exit.side->kind == SideKind::outlet) return {true, nullptr};
  for (const auto& inlet : inlets)
    if (&domain.named_side(inlet.side) == exit.side) return {false, &inlet};
  return {};
}

bool is_open(const CellGrid& grid, std::int32_t c) {
  return c != none && grid.is_open(static_cast<std::size_t>(c));
}

// Behind a side of a cell.
Beyond beyond(const Domain& domain, const std::vector<GasInlet>& inlets, const CellGrid& grid, std::size_t c,
              std::size_t axis, int side) {
  Vec outside = grid.centre(c);
  (axis == 0 ? outside.x : axis == 1 ? outside.y : outside.z) += side * grid.step()[axis];
  return beyond(domain, inlets, grid.centre(c), outside);
}

}  // namespace

void GasFlow::find_faces(const Domain& domain, const std::vector<GasInlet>& inlets) {
  const auto& g = *grid_;
  bool has_outlets = false, has_inlets = false;
  for (std::size_t c = 0; c < g.size(); ++c)
    for (std::size_t a = 0; a < 3 && g.is_open(c); ++a)
      for (const int side : {-1, 1}) {
        const auto other = g.neighbour(c, a, side);
        const auto number = g.face(c, a, side);
        const auto me = static_cast<std::int32_t>(c);
        if (is_open(g, other)) {
          if (side < 0) faces_.push_back({Face::Kind::inside, a, number, other, me});
          continue;
        }
        const auto what = beyond(domain, inlets, g, c, a, side);
        Face face{Face::Kind::wall, a, number, side < 0 ? none : me, side < 0 ? me : none};
        if (what.inlet != nullptr) face.inflow = array_of(what.inlet->velocity)[a];
        if (face.inflow != 0) face.kind = Face::Kind::inlet;
        if (what.is_outlet) face.kind = Face::Kind::outlet;
        has_outlets = has_outlets || what.is_outlet;
        has_inlets = has_inlets || face.kind == Face::Kind::inlet;
        if (face.kind != Face::Kind::wall) grid_->open_face(a, number);
        faces_.push_back(face);
      }
  if (has_inlets && !has_outlets)
    throw UsageError(Problem{.what = "gas comes in and has nowhere to go", .expected = "domain.outlets"});
  for (auto& face : faces_) look_around(domain, inlets, face);
}

void GasFlow::look_around(const Domain& domain, const std::vector<GasInlet>& inlets, Face& face) const {
  const auto& g = *grid_;
  const std::size_t inner = face.inner(), a = face.axis;
  const auto near = [&](std::int32_t c, int side) -> std::int32_t {
    if (c == none) return none;
    const auto f = g.face(static_cast<std::size_t>(c), a, side);
    return static_cast<std::int32_t>(f);
  };
  face.along = {near(face.low, -1), near(face.high, 1)};
  for (std::size_t b = 0; b < 3; ++b) {
    if (b == a) continue;
    const auto at_low = face.low == none ? inner : static_cast<std::size_t>(face.low),
               at_high = face.high == none ? inner : static_cast<std::size_t>(face.high);
    face.cross[b] = {
        static_cast<std::int32_t>(g.face(at_low, b, -1)), static_cast<std::int32_t>(g.face(at_low, b, 1)),
        static_cast<std::int32_t>(g.face(at_high, b, -1)), static_cast<std::int32_t>(g.face(at_high, b, 1))};
    for (const int side : {-1, 1}) {
      const auto k = static_cast<std::size_t>(side > 0);
      const auto beside = g.neighbour(inner, b, side);
      face.beside[b][k] = none, face.wall[b][k] = 0;
      if (is_open(g, beside)) {
        const auto f = g.face(static_cast<std::size_t>(beside), a, face.low == none ? -1 : 1);
        if (g.is_face_open(a, f)) face.beside[b][k] = static_cast<std::int32_t>(f);
        continue;
      }
      const auto what = beyond(domain, inlets, g, inner, b, side);
      if (what.is_outlet) face.beside[b][k] = static_cast<std::int32_t>(face.number);
      if (what.inlet != nullptr) face.wall[b][k] = array_of(what.inlet->velocity)[a];
    }
  }
}

// What comes through the faces of a side is what would come through the side.
void GasFlow::scale_inlets(const Domain& domain, const std::vector<GasInlet>& inlets) {
  for (const auto& inlet : inlets) {
    const auto& side = domain.named_side(inlet.side);
    double found = 0;
    std::vector<Face*> mine;
    for (auto& face : faces_) {
      if (face.kind != Face::Kind::inlet) continue;
      const int way = face.low == none ? -1 : 1;
      if (beyond(domain, inlets, *grid_, face.inner(), face.axis, way).inlet != &inlet) continue;
      mine.push_back(&face);
      found += (face.low == none ? 1 : -1) * face.inflow * grid_->volume() / grid_->step()[face.axis];
    }
    const double wanted = dot(inlet.velocity, side.normal) * domain.area_of(side);
    if (mine.empty() && wanted > 0)
      throw UsageError(Problem{.what = "no face of the grid lies on the gas inlet",
                               .found = "'" + inlet.side + "'",
                               .advice = "a smaller grid.cell"});
    for (auto* face : mine)
      if (found > 0 && wanted > 0) face->inflow *= wanted / found;
  }
  for (const auto& face : faces_)
    if (face.kind == Face::Kind::inlet) velocity_[face.axis][face.number] = face.inflow;
}

GasLoad GasFlow::no_load() const {
  GasLoad load;
  for (auto* values : {&load.solids, &load.solids_flux, &load.exchange, &load.exchange_flux})
    for (std::size_t a = 0; a < 3; ++a) (*values)[a].assign(grid_->face_count(a), 0);
  return load;
}

double GasFlow::step_of(double dt) const {
  double rate = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    double fastest = 0;
    for (const double u : velocity_[a]) fastest = std::max(fastest, std::abs(u));
    rate += fastest / grid_->step()[a];
  }
  if (!(rate < 1e15))
    throw NumericalError(
        Problem{.what = "the gas's speed is no number any more", .advice = "take a shorter time step"});
  return dt / std::max(1.0, std::ceil(dt * rate / courant));
}

void GasFlow::advance(double dt, const GasLoad& load) {
  for (auto& values : mean_) std::ranges::fill(values, 0);
  std::ranges::fill(mean_pressure_, 0);
  n_steps_ = 0;
  for (double left = dt; left > 1e-9 * dt;) {
    const double h = std::min(left, step_of(left));
    step(h, load);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t f = 0; f < mean_[a].size(); ++f) mean_[a][f] += h / dt * velocity_[a][f];
    for (std::size_t c = 0; c < pressure_.size(); ++c) mean_pressure_[c] += h / dt * pressure_[c];
    left -= h;
    ++n_steps_;
  }
  find_held(load);
  look(load);
}

void GasFlow::find_held(const GasLoad& load) {
  held_.clear();
  for (const auto& face : faces_) {
    if (!face.is_given()) continue;
    const auto a = face.axis, f = face.number;
    const double drag = load.exchange[a][f] * velocity_[a][f] - load.exchange_flux[a][f];
    held_.push_back(force_[a] - drag / gap(face, load));
  }
}

double GasFlow::gap(const Face& face, const GasLoad& load) const {
  return std::max(least_voidage, 1 - load.solids[face.axis][face.number]);
}

double GasFlow::drop(const Face& face, const std::vector<double>& p) const {
  const double low = face.low == none ? 0 : p[static_cast<std::size_t>(face.low)],
               high = face.high == none ? 0 : p[static_cast<std::size_t>(face.high)];
  return (high - low) / (grid_->step()[face.axis] * (face.kind == Face::Kind::outlet ? 0.5 : 1));
}

void GasFlow::step(double dt, const GasLoad& load) {
  foresee(dt, load);
  project(load);
}

// What a face's velocity takes from those around it by convection and viscosity, 1/s each.
struct GasFlow::Links {
  std::array<std::int32_t, 6> number;  // of faces along the same axis; none: a wall, or nothing
  std::array<double, 6> rate;
  double sum = 0, wall = 0;  // sum of rates; 1/s times the walls' velocity
};

// Gas carries its velocity through the sides of the face's cell with its own flux, and none through walls.
GasFlow::Links GasFlow::links(const Face& face, double eps) const {
  Links links;
  const double nu = gas_.viscosity / gas_.density;
  for (std::size_t b = 0; b < 3; ++b) {
    const double h = grid_->step()[b];
    for (std::size_t k = 0; k < 2; ++k) {
      const bool is_along = b == face.axis;
      const auto number = is_along ? face.along[k] : face.beside[b][k];
      const bool is_wall = number == none && !is_along;  // half a cell away, where the gas stands with it
      double through = 0;
      if (!is_along)
        through = 0.5 * (flux(b, face.cross[b][k]) + flux(b, face.cross[b][k + 2]));
      else if (number != none)
        through = 0.5 * (flux_[b][face.number] + flux(b, number));
      const double inflow = k == 0 ? through : -through, spread = eps * nu / h;
      const double rate = (is_wall ? 2 * spread + std::max(0.0, inflow)
                                   : std::max(spread, 0.5 * std::abs(through)) + 0.5 * inflow) /
                          (h * eps);
      links.number[2 * b + k] = number;
      links.rate[2 * b + k] = number == none ? 0 : rate;
      links.sum += is_wall ? rate : links.rate[2 * b + k];
      links.wall += is_wall ? rate * face.wall[b][k] : 0;
    }
  }
  return links;
}

// Velocities with the pressure of before; convection and viscosity at the end of the step, by sweeps to and
// fro, each of which keeps what it finds between the values around.
void GasFlow::foresee(double dt, const GasLoad& load) {
  before_ = velocity_;
  for (const auto& face : faces_)
    flux_[face.axis][face.number] = gap(face, load) * before_[face.axis][face.number];
  std::vector<Links> around(faces_.size());
  for (std::size_t k = 0; k < faces_.size(); ++k) {
    const auto& face = faces_[k];
    const double eps = gap(face, load);
    if (face.is_given()) {
      velocity_[face.axis][face.number] = face.inflow / eps;
      continue;
    }
    hold_[face.axis][face.number] = gas_.density * eps / dt + load.exchange[face.axis][face.number];
    around[k] = links(face, eps);
  }
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double change = 0, largest = 0;
    for (std::size_t n = 0; n < faces_.size(); ++n) {
      const auto k = sweep % 2 == 0 ? n : faces_.size() - 1 - n;
      if (faces_[k].is_given()) continue;
      double& own = velocity_[faces_[k].axis][faces_[k].number];
      const double found = foreseen(faces_[k], around[k], dt, load);
      change = std::max(change, std::abs(found - own)), largest = std::max(largest, std::abs(found));
      own = found;
    }
    if (change <= enough * largest) break;
  }
}

double GasFlow::foreseen(const Face& face, const Links& around, double dt, const GasLoad& load) const {
  const auto a = face.axis, f = face.number;
  const double eps = gap(face, load), inertia = gas_.density * eps / dt;
  double carried = around.wall;
  for (std::size_t k = 0; k < 6; ++k)
    if (around.number[k] != none)
      carried += around.rate[k] * velocity_[a][static_cast<std::size_t>(around.number[k])];
  return (inertia * (before_[a][f] + dt * carried) + load.exchange_flux[a][f] +
          eps * (force_[a] - drop(face, pressure_))) /
         (hold_[a][f] + inertia * dt * around.sum);
}

// The change of pressure that lets gas and solids fill space.
void GasFlow::project(const GasLoad& load) {
  auto& [equation, solver] = *equation_;
  equation.clear();
  for (const auto& face : faces_) {
    const auto a = face.axis, f = face.number;
    const double eps = gap(face, load), area = grid_->volume() / grid_->step()[a];
    const double solids = face.is_given() ? 0 : load.solids_flux[a][f];  // none pass inlets and walls
    const double flux = area * (eps * velocity_[a][f] + solids);
    if (face.low != none) equation.right[static_cast<std::size_t>(face.low)] -= flux;
    if (face.high != none) equation.right[static_cast<std::size_t>(face.high)] += flux;
    if (face.is_given()) continue;
    const double conductance = area * eps * eps / (hold_[a][f] * grid_->step()[a]);
    if (face.kind == Face::Kind::inside)
      equation.conductance[a][f] = conductance;
    else
      equation.diagonal[face.inner()] += 2 * conductance;
  }
  std::ranges::fill(correction_, 0);
  solver->solve(equation, correction_, tolerance);
  for (std::size_t c = 0; c < pressure_.size(); ++c) pressure_[c] += correction_[c];
  for (const auto& face : faces_) {
    if (face.is_given()) continue;
    const auto a = face.axis, f = face.number;
    velocity_[a][f] -= gap(face, load) / hold_[a][f] * drop(face, correction_);
  }
}

FaceValues GasFlow::pressure_gradient() const {
  FaceValues gradient;
  for (std::size_t a = 0; a < 3; ++a) gradient[a].assign(grid_->face_count(a), 0);
  auto held = held_.begin();
  for (const auto& face : faces_)
    gradient[face.axis][face.number] = face.is_given() ? *held++ : drop(face, mean_pressure_);
  return gradient;
}

// Balances of the last step.
void GasFlow::look(const GasLoad& load) {
  std::vector<double> sum(grid_->size());
  double largest = 0;
  flow_in_ = flow_out_ = 0;
  for (const auto& face : faces_) {
    const double area = grid_->volume() / grid_->step()[face.axis];
    const double gas = area * gap(face, load) * velocity_[face.axis][face.number];
    const double flux = gas + (face.is_given() ? 0 : area * load.solids_flux[face.axis][face.number]);
    if (face.low != none) sum[static_cast<std::size_t>(face.low)] += flux;
    if (face.high != none) sum[static_cast<std::size_t>(face.high)] -= flux;
    largest = std::max(largest, std::abs(flux));
    if (face.kind == Face::Kind::inlet) flow_in_ += face.low == none ? gas : -gas;
    if (face.kind == Face::Kind::outlet) flow_out_ += face.low == none ? -gas : gas;
  }
  double most = 0;
  for (const double value : sum) most = std::max(most, std::abs(value));
  divergence_ = largest > 0 ? most / largest : 0;
}

double GasFlow::inlet_pressure() const {
  double sum = 0, n = 0;
  const auto gradient = pressure_gradient();
  for (const auto& face : faces_) {
    if (face.kind != Face::Kind::inlet) continue;
    const double half = (face.low == none ? -0.5 : 0.5) * grid_->step()[face.axis];
    sum += mean_pressure_[face.inner()] + half * gradient[face.axis][face.number];
    ++n;
  }
  return n > 0 ? sum / n : 0;
}

std::size_t GasFlow::bytes() const {
  std::size_t doubles = 5 * pressure_.capacity();
  for (std::size_t a = 0; a < 3; ++a) doubles += 6 * velocity_[a].capacity();
  return doubles * sizeof(double) + faces_.capacity() * sizeof(Face) + grid_->bytes();
}

void GasFlow::save(io::TensorFile& file) const {
  file.set("gas_pressure", io::Tensor::copy(pressure_, {pressure_.size()}));
  file.set("gas_mean_pressure", io::Tensor::copy(mean_pressure_, {mean_pressure_.size()}));
  file.set("gas_held_gradient", io::Tensor::copy(held_, {held_.size()}));
  for (std::size_t a = 0; a < 3; ++a)
    file.set("gas_velocity_" + std::string(1, "xyz"[a]),
             io::Tensor::copy(velocity_[a], {velocity_[a].size()}));
}

void GasFlow::load(const io::TensorFile& file) {
  const auto read = [&](const std::string& name, std::vector<double>& into) {
    const auto values = file.tensor(name, std::array{into.size()}).f64();
    into.assign(values.begin(), values.end());
    if (!std::ranges::all_of(into, [](double v) { return std::isfinite(v); }))
      throw InputError(Problem{
          .what = "a damaged checkpoint", .where = file.where() + ":" + name, .expected = "finite numbers"});
  };
  read("gas_pressure", pressure_);
  read(file.has("gas_mean_pressure") ? "gas_mean_pressure" : "gas_pressure", mean_pressure_);
  if (file.has("gas_held_gradient")) read("gas_held_gradient", held_);
  for (std::size_t a = 0; a < 3; ++a) read("gas_velocity_" + std::string(1, "xyz"[a]), velocity_[a]);
}

}  // namespace elrom::scene
