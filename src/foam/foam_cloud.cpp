#include "elrom/foam/foam_cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/foam/foam_text.hpp"

namespace elrom::foam {
namespace {

double solids_volume(const FoamMesh& mesh, const SolidFields& fields, std::size_t cell) {
  return mesh.volume[cell] * std::max(0.0, static_cast<double>(fields.volume_fraction[cell]));
}

/// Uniform over a tetrahedron: the gaps between three sorted numbers.
Eigen::Vector4d any_weights(base::Random& random) {
  std::array<double, 3> cuts{random.uniform(), random.uniform(), random.uniform()};
  std::sort(cuts.begin(), cuts.end());
  return {cuts[0], cuts[1] - cuts[0], cuts[2] - cuts[1], 1 - cuts[2]};
}

/// Tetrahedra of one cell, and a place in them.
class Body {
 public:
  Body(const FoamCells& cells, std::size_t cell) : tetrahedra_(cells.tetrahedra(cell)) {
    for (const auto& tet : tetrahedra_) sums_.push_back(tet.volume + (sums_.empty() ? 0 : sums_.back()));
    check(!sums_.empty(), "a cell with a volume has a tetrahedron with one");
  }
  [[nodiscard]] Parcel place(base::Random& random) const {
    const auto found = std::upper_bound(sums_.begin(), sums_.end() - 1, sums_.back() * random.uniform());
    const auto& tet = tetrahedra_[static_cast<std::size_t>(found - sums_.begin())];
    const Eigen::Vector4d weights = any_weights(random);
    return {.cell = tet.cell,
            .face = tet.face,
            .point = tet.point,
            .weights = weights,
            .position = tet.corners * weights,
            .velocity = {},
            .diameter = 0,
            .count = 0};
  }

 private:
  std::vector<Tetrahedron> tetrahedra_;
  std::vector<double> sums_;
};

/// What is to be spread within cells, so that all parcels together have the spread that is wanted.
double spread_within(const FoamMesh& mesh, const SolidFields& fields, double wanted) {
  double total = 0, sum = 0, square = 0;
  for (std::size_t cell = 0; cell < mesh.volume.size(); ++cell) {
    const double solids = solids_volume(mesh, fields, cell), diameter = fields.diameter[cell];
    if (!(solids > 0 && diameter > 0)) continue;
    total += solids;
    sum += solids * std::log(diameter);
    square += solids * std::pow(std::log(diameter), 2);
  }
  const double between = total > 0 ? square / total - std::pow(sum / total, 2) : 0;
  return std::sqrt(std::max(0.0, wanted * wanted - std::max(0.0, between)));
}

double spread_factor(double spread, base::Random& random) {
  constexpr double widest = 3;
  if (spread <= 0) return 1;
  return std::exp(spread * std::clamp(random.normal(), -widest, widest) - 0.5 * spread * spread);
}

class Files {
 public:
  Files(std::filesystem::path folder, const std::vector<Parcel>& parcels, std::string location,
        std::string note)
      : folder_(std::move(folder)),
        parcels_(parcels),
        location_(std::move(location)),
        note_(std::move(note)) {}

  using Line = std::function<void(std::string&, const Parcel&)>;
  void write(const std::string& name, const char* class_name, const Line& line) const {
    std::string text = header(class_name, location_, name, note_) + std::to_string(parcels_.size()) + "\n(\n";
    for (const auto& parcel : parcels_) {
      line(text, parcel);
      text += '\n';
    }
    base::write_text(folder_ / name, text + ")\n");
  }
  void write_same(const std::string& name, const char* class_name, std::string_view value) const {
    base::write_text(folder_ / name, fmt::format("{}{}{{{}}}\n", header(class_name, location_, name, note_),
                                                 parcels_.size(), value));
  }

 private:
  std::filesystem::path folder_;
  const std::vector<Parcel>& parcels_;
  std::string location_, note_;
};

}  // namespace

std::vector<Parcel> draw_cloud(const FoamMesh& mesh, const SolidFields& fields, const CloudSettings& settings,
                               base::Seed seed) {
  const auto n_cells = mesh.volume.size();
  double total = 0;
  for (std::size_t cell = 0; cell < n_cells; ++cell) total += solids_volume(mesh, fields, cell);
  std::vector<Parcel> parcels;
  if (!(total > 0)) return parcels;
  const FoamCells cells(mesh);
  base::Random random(seed);
  const double of_one = total / static_cast<double>(settings.n_parcels);
  const double start = random.uniform(), spread = spread_within(mesh, fields, settings.spread);
  double sum = 0;
  for (std::size_t cell = 0; cell < n_cells && parcels.size() < settings.n_parcels; ++cell) {
    sum += solids_volume(mesh, fields, cell) / of_one;
    const bool last = cell + 1 == n_cells;  // where rounding of the sum may not lose a parcel
    const auto up_to =
        std::min(settings.n_parcels,
                 last ? settings.n_parcels : static_cast<std::size_t>(std::ceil(std::max(0.0, sum - start))));
    if (parcels.size() >= up_to) continue;
    if (!(fields.diameter[cell] > 0)) {
      throw InputError({.what = "solids without a diameter",
                        .where = "cell " + std::to_string(cell),
                        .found = std::to_string(fields.diameter[cell]) + " m"});
    }
    const Body body(cells, cell);
    while (parcels.size() < up_to) {
      auto parcel = body.place(random);
      parcel.velocity = {fields.velocity_x[cell], fields.velocity_y[cell], fields.velocity_z[cell]};
      parcel.diameter = fields.diameter[cell] * spread_factor(spread, random);
      parcel.count = of_one / (std::numbers::pi / 6 * std::pow(parcel.diameter, 3));
      parcels.push_back(parcel);
    }
  }
  return parcels;
}

void write_cloud(const std::filesystem::path& folder, const std::vector<Parcel>& parcels, double density,
                 const std::string& time, const std::string& note) {
  std::filesystem::create_directories(folder);
  const Files files(folder, parcels, time + "/lagrangian/" + folder.filename().string(), note);
  const char* cloud = "Cloud<basicKinematicMPPICParcel>";
  files.write("coordinates", cloud, [](std::string& text, const Parcel& p) {
    fmt::format_to(std::back_inserter(text), "({:.9g} {:.9g} {:.9g} {:.9g}) {} {} {}", p.weights[0],
                   p.weights[1], p.weights[2], p.weights[3], p.cell, p.face, p.point);
  });
  files.write("positions", cloud, [](std::string& text, const Parcel& p) {
    fmt::format_to(std::back_inserter(text), "({:.9g} {:.9g} {:.9g}) {}", p.position[0], p.position[1],
                   p.position[2], p.cell);
  });
  files.write("U", "vectorField", [](std::string& text, const Parcel& p) {
    fmt::format_to(std::back_inserter(text), "({:.7g} {:.7g} {:.7g})", p.velocity[0], p.velocity[1],
                   p.velocity[2]);
  });
  files.write("nParticle", "scalarField", [](std::string& text, const Parcel& p) {
    fmt::format_to(std::back_inserter(text), "{:.9g}", p.count);
  });
  for (const auto* name : {"d", "dTarget"}) {
    files.write(name, "scalarField", [](std::string& text, const Parcel& p) {
      fmt::format_to(std::back_inserter(text), "{:.9g}", p.diameter);
    });
  }
  files.write_same("rho", "scalarField", fmt::format("{}", density));
  for (const auto* name : {"age", "tTurb"}) files.write_same(name, "scalarField", "0");
  for (const auto* name : {"UTurb", "UCorrect"}) files.write_same(name, "vectorField", "(0 0 0)");
  files.write_same("active", "labelField", "1");
  files.write_same("typeId", "labelField", "-1");
  files.write_same("origProcId", "labelField", "0");
  files.write("origId", "labelField",
              [&](std::string& text, const Parcel& p) { text += std::to_string(&p - parcels.data()); });
}

}  // namespace elrom::foam
