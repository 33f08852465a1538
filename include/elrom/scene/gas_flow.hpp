#pragma once
// A gas that flows through a domain, between spheres and answering them: volume-averaged, incompressible,
// on a staggered grid (cell_grid.hpp).
//
//   div(eps u + S) = 0            S: flux of the solids, so that gas and solids fill space
//   d(eps rho u)/dt + div(eps rho u u) = -eps grad p + eps mu lap u + K (u_s - u)
//
// p is without the gas's own weight; spheres' buoyancy is an effect of its own. The drag is implicit, in the
// pressure's equation too, so that no K makes it unstable; convection and viscosity are implicit too, in
// steps in which the gas crosses four cells at most. Convection is in advective form, by the gas's own flux
// eps u: it conserves momentum where gas alone fills space, and nearly where solids move. Central
// differences, with as much diffusion as keeps them monotone (Spalding's hybrid scheme): second order where
// |u| h < 2 nu, first where it is faster. Walls: no slip, and no flux; cells are in or out, so walls that
// lean are stairs. Inlets: a velocity, scaled so that the side's flow is exact. Outlets: pressure 0.
//
// Thread rule: one thread.

#include <memory>
#include <string>

#include "elrom/io/tensor_file.hpp"
#include "elrom/particle/drag.hpp"
#include "elrom/scene/cell_grid.hpp"

namespace elrom::scene {

/// By face along each axis.
using FaceValues = std::array<std::vector<double>, 3>;

struct GasInlet {
  std::string side;  ///< "box.z_low"
  Vec velocity;      ///< m/s, over the whole cross section; along the side it moves the wall
};

/// What spheres do to the gas, by faces.
struct GasLoad {
  FaceValues solids;         ///< fraction
  FaceValues solids_flux;    ///< m/s: fraction times velocity
  FaceValues exchange;       ///< K, kg/(m3 s)
  FaceValues exchange_flux;  ///< K times the spheres' velocity, N/m3
};

class CellSolver;

class GasFlow {
 public:
  /// @param domain lives longer @param force on the gas, N/m3, e.g. what drives it through a period
  /// @throws UsageError for inlets without an outlet, and sides that are none or lie outside the grid
  GasFlow(const Domain& domain, std::shared_ptr<CellGrid> grid, const particle::Gas& gas,
          const std::vector<GasInlet>& inlets, const Vec& force = {});
  ~GasFlow();
  GasFlow(const GasFlow&) = delete;
  GasFlow& operator=(const GasFlow&) = delete;

  /// @throws NumericalError where something is no number any more
  void advance(double dt, const GasLoad& load);
  [[nodiscard]] GasLoad no_load() const;  ///< all zero

  [[nodiscard]] const CellGrid& grid() const { return *grid_; }
  [[nodiscard]] const particle::Gas& gas() const { return gas_; }
  [[nodiscard]] const FaceValues& velocity() const { return velocity_; }  ///< m/s, between the spheres
  /// Mean over the last advance().
  [[nodiscard]] const FaceValues& mean_velocity() const { return mean_; }
  [[nodiscard]] const std::vector<double>& pressure() const { return pressure_; }  ///< Pa, by cell
  /// grad p, Pa/m, by face, mean over the last advance(), as spheres feel it. On inlets and
  /// walls, where the gas's velocity is given, it is what holds the drag there.
  [[nodiscard]] FaceValues pressure_gradient() const;

  /// Gas that came in and went out in the last advance(), m3/s. With the solids' own displacement they
  /// balance to the tolerance of the pressure's equation.
  [[nodiscard]] double flow_in() const { return flow_in_; }
  [[nodiscard]] double flow_out() const { return flow_out_; }
  /// Largest |div(eps u + S)| over the largest flux through a face per cell size.
  [[nodiscard]] double divergence() const { return divergence_; }
  /// Mean pressure on the inlets over the last advance(), Pa; 0 without.
  [[nodiscard]] double inlet_pressure() const;
  [[nodiscard]] int steps() const { return n_steps_; }  ///< in the last advance()

  [[nodiscard]] std::size_t bytes() const;
  void save(io::TensorFile& file) const;
  void load(const io::TensorFile& file);

 private:
  struct Face;
  struct Equation;
  struct Links;
  void find_faces(const Domain& domain, const std::vector<GasInlet>& inlets);
  void look_around(const Domain& domain, const std::vector<GasInlet>& inlets, Face& face) const;
  void scale_inlets(const Domain& domain, const std::vector<GasInlet>& inlets);
  [[nodiscard]] double step_of(double dt) const;
  void step(double dt, const GasLoad& load);
  void foresee(double dt, const GasLoad& load);
  void project(const GasLoad& load);
  [[nodiscard]] double flux(std::size_t axis, std::int32_t face) const {
    return flux_[axis][static_cast<std::size_t>(face)];
  }
  [[nodiscard]] Links links(const Face& face, double eps) const;
  [[nodiscard]] double foreseen(const Face& face, const Links& around, double dt, const GasLoad& load) const;
  [[nodiscard]] double gap(const Face& face, const GasLoad& load) const;
  [[nodiscard]] double drop(const Face& face, const std::vector<double>& p) const;  // gradient
  void look(const GasLoad& load);
  void find_held(const GasLoad& load);

  std::shared_ptr<CellGrid> grid_;
  particle::Gas gas_;
  std::array<double, 3> force_;
  std::vector<Face> faces_;
  std::unique_ptr<Equation> equation_;
  FaceValues velocity_, mean_, before_, flux_, hold_;  // flux_: eps u; hold_: rho eps / dt + K
  std::vector<double> pressure_, mean_pressure_, correction_;
  std::vector<double> held_;  // grad p where the velocity is given: inlets and walls, in their order
  double flow_in_ = 0, flow_out_ = 0, divergence_ = 0;
  int n_steps_ = 0;
};

}  // namespace elrom::scene
