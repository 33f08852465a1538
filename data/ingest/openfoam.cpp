// OpenFOAM case directories of an MPPICFoam run (gas fields on
// a polyMesh, solids as parcels of a Lagrangian cloud).
//
// Averages over instants t and parcels p in the cell, with parcel mass m = n rho pi d^3 / 6 and parcel volume
// v = n pi d^3 / 6 (n = nParticle), cell volume V and gas fraction e_t = 1 - sum_p v / V:
//   solid velocity        sum m u / sum m           (Favre: mass-weighted)
//   gas velocity          sum_t e_t U_t / sum_t e_t (Favre: the gas density is constant)
//   solid volume fraction mean_t (sum_p v / V)
//   solid diameter        sum m d / sum m
//   pressure              mean_t(p) * gas density   (the solver's p is kinematic)
// Where no parcel came by: the gas velocity, and the mass-median diameter of all parcels (the case's d50 as
// it is run).

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/foam/foam_file.hpp"
#include "elrom/foam/foam_mesh.hpp"
#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {
namespace {

namespace fs = std::filesystem;

struct Instant {
  double time = 0;
  fs::path folder;
};

/// Time folders that hold the gas velocity; the initial state at time 0 is no result.
std::vector<Instant> find_instants(const fs::path& directory, const std::string& gas) {
  std::vector<Instant> instants;
  for (const auto& entry : fs::directory_iterator(directory)) {
    const auto time = base::to_double(entry.path().filename().string());
    if (!entry.is_directory() || !time || !(*time > 0)) continue;
    if (foam::FoamFile::exists(entry.path() / ("U." + gas))) instants.push_back({*time, entry.path()});
  }
  if (instants.empty()) {
    throw InputError({.what = "no instants to average",
                      .where = directory.string(),
                      .expected = "time folders with U." + gas + " and a Lagrangian cloud"});
  }
  std::sort(instants.begin(), instants.end(),
            [](const Instant& a, const Instant& b) { return a.time < b.time; });
  return instants;
}

/// The only cloud of an instant, or the one with MPPICFoam's usual name.
fs::path find_cloud(const fs::path& instant) {
  const auto folder = instant / "lagrangian";
  std::vector<fs::path> clouds;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.is_directory()) clouds.push_back(entry.path());
    }
  }
  if (clouds.size() == 1) return clouds.front();
  const auto usual = folder / "kinematicCloud";
  if (fs::is_directory(usual)) return usual;
  throw InputError({.what = "cannot tell the solids' cloud",
                    .where = folder.string(),
                    .found = std::to_string(clouds.size()) + " clouds",
                    .expected = "one, or one named kinematicCloud"});
}

struct Parcels {
  std::vector<std::size_t> cell;
  MatrixD velocity;              //!< [m/s], (n, 3)
  std::vector<double> diameter;  //!< [m]
  std::vector<double> count;     //!< real particles a parcel stands for
  std::vector<double> density;   //!< [kg/m3]
};

// `coordinates` holds (a b c d) cell face point, `positions`
// holds (x y z) cell: the cell is all that is needed.
std::vector<std::size_t> read_parcel_cells(const fs::path& cloud, std::size_t n_cells) {
  foam::FoamFile file(foam::FoamFile::exists(cloud / "coordinates") ? cloud / "coordinates"
                                                                    : cloud / "positions");
  file.to_body();
  std::vector<std::size_t> cells(file.list_size(0, 9));
  file.expect("(");
  for (auto& cell : cells) {
    file.expect("(");
    while (file.token() != ")") {
    }
    cell = file.label();
    if (cell >= n_cells) file.fail("cell " + std::to_string(cell), "below " + std::to_string(n_cells));
    while (file.peek() != "(" && file.peek() != ")") file.label();
  }
  file.expect(")");
  return cells;
}

std::vector<double> read_parcel_scalars(const fs::path& path, std::size_t n) {
  foam::FoamFile file(path);
  file.to_body();
  auto values = file.scalars(n);
  const auto bad = std::find_if(values.begin(), values.end(), [](double value) { return !(value > 0); });
  if (bad != values.end()) file.fail(base::number(*bad), "positive values");
  return values;
}

Parcels read_parcels(const fs::path& cloud, std::size_t n_cells) {
  Parcels parcels;
  parcels.cell = read_parcel_cells(cloud, n_cells);
  const auto n = parcels.cell.size();
  if (n == 0) return parcels;
  foam::FoamFile velocity(cloud / "U");
  velocity.to_body();
  parcels.velocity = velocity.vectors(n);
  parcels.diameter = read_parcel_scalars(cloud / "d", n);
  parcels.count = read_parcel_scalars(cloud / "nParticle", n);
  parcels.density = read_parcel_scalars(cloud / "rho", n);
  return parcels;
}

/// Sums over instants.
class Averages {
 public:
  explicit Averages(foam::FoamMesh mesh)
      : mesh_(std::move(mesh)),
        n_(mesh_.centre.rows()),
        gas_momentum_(MatrixD::Zero(n_, 3)),
        solid_momentum_(MatrixD::Zero(n_, 3)),
        gas_weight_(Eigen::VectorXd::Zero(n_)),
        mass_(gas_weight_),
        mass_diameter_(gas_weight_),
        fraction_(gas_weight_),
        pressure_(gas_weight_) {}

  void add(const Instant& instant, const std::string& gas) {
    const auto n_cells = static_cast<std::size_t>(n_);
    const auto velocity = foam::read_internal_field(instant.folder / ("U." + gas), n_cells, 3);
    const auto pressure = foam::read_internal_field(instant.folder / "p", n_cells, 1);
    const Eigen::VectorXd fraction = add_parcels(read_parcels(find_cloud(instant.folder), n_cells));
    const Eigen::VectorXd gas_fraction = 1.0 - fraction.array();
    gas_momentum_ += gas_fraction.asDiagonal() * velocity;
    gas_weight_ += gas_fraction;
    fraction_ += fraction;
    pressure_ += pressure.col(0);
    ++n_instants_;
  }

  /// (9, n_cells) in the order of field::standard_fields()
  [[nodiscard]] MatrixF fields(double gas_density, const fs::path& directory) const {
    MatrixD result(9, n_);
    const double d50 = median_diameter();
    for (Eigen::Index i = 0; i < n_; ++i) {
      const Eigen::RowVector3d gas = gas_momentum_.row(i) / gas_weight_(i);
      const bool visited = mass_(i) > 0;
      Eigen::RowVector3d solid = gas;
      if (visited) solid = solid_momentum_.row(i) / mass_(i);
      result.col(i).segment<3>(0) = solid.transpose();
      result.col(i).segment<3>(3) = gas.transpose();
      result(6, i) = pressure_(i) / n_instants_ * gas_density;
      result(7, i) = visited ? mass_diameter_(i) / mass_(i) : d50;
      result(8, i) = fraction_(i) / n_instants_;
    }
    if (!result.allFinite()) {
      throw InputError(
          {.what = "instants give no finite averages",
           .where = directory.string(),
           .advice = "look for a cell that parcels fill entirely, or for a cloud without parcels"});
    }
    return result.cast<float>();
  }
  [[nodiscard]] const foam::FoamMesh& mesh() const { return mesh_; }

 private:
  /// @return the solids' share of each cell at this instant
  Eigen::VectorXd add_parcels(const Parcels& parcels) {
    Eigen::VectorXd fraction = Eigen::VectorXd::Zero(n_);
    for (std::size_t p = 0; p < parcels.cell.size(); ++p) {
      const auto i = static_cast<Eigen::Index>(parcels.cell[p]);
      const double d = parcels.diameter[p];
      const double volume = parcels.count[p] * std::numbers::pi / 6 * d * d * d;
      const double mass = parcels.density[p] * volume;
      solid_momentum_.row(i) += mass * parcels.velocity.row(static_cast<Eigen::Index>(p));
      mass_(i) += mass;
      mass_diameter_(i) += mass * d;
      fraction(i) += volume / mesh_.volume[parcels.cell[p]];
      sizes_.emplace_back(d, mass);
    }
    return fraction;
  }

  /// Half of the parcels' mass is finer than this; NaN without parcels.
  [[nodiscard]] double median_diameter() const {
    auto sizes = sizes_;
    std::sort(sizes.begin(), sizes.end());
    const double half = 0.5 * std::accumulate(sizes.begin(), sizes.end(), 0.0,
                                              [](double sum, const auto& size) { return sum + size.second; });
    double below = 0;
    for (const auto& [diameter, mass] : sizes) {
      below += mass;
      if (below >= half) return diameter;
    }
    return std::nan("");
  }

  foam::FoamMesh mesh_;
  Eigen::Index n_;
  MatrixD gas_momentum_, solid_momentum_;
  Eigen::VectorXd gas_weight_, mass_, mass_diameter_, fraction_, pressure_;
  //! Diameter [m] and mass [kg] of every parcel at every instant
  std::vector<std::pair<double, double>> sizes_;
  double n_instants_ = 0;
};

std::string directory_name(const fs::path& directory) {
  const auto path = fs::absolute(directory).lexically_normal();
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

}  // namespace

CfdCase read_openfoam(const std::filesystem::path& directory) {
  foam::FoamFile properties(directory / "constant" / "transportProperties");
  const auto gas = properties.dictionary_word("continuousPhase");
  const double gas_density = properties.dictionary_number("rho." + gas);
  const auto instants = find_instants(directory, gas);
  Averages averages(foam::read_poly_mesh(directory / "constant" / "polyMesh"));
  for (const auto& instant : instants) averages.add(instant, gas);

  const auto fields = field::standard_fields();
  CfdCase result;
  result.record.source = result.record.inputs.name = directory_name(directory);
  result.record.inputs.load = std::nan("");
  result.record.averaging_window_s = instants.back().time - instants.front().time;
  result.fields.assign(fields.begin(), fields.end());
  result.centre = averages.mesh().centre;
  result.volume = averages.mesh().volume;
  result.values = averages.fields(gas_density, directory);
  return result;
}

}  // namespace elrom::ingest
