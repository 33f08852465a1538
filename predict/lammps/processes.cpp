#include "elrom/lammps/processes.hpp"

#include "elrom/base/error.hpp"
#include "elrom/scene/simulation.hpp"
#include "shared_mover.hpp"

namespace elrom::lammps {
namespace {

void refuse(bool refused, const char* what, const std::string& found, const char* expected) {
  if (refused)
    throw UsageError(Problem{.what = std::string("engine lammps cannot do ") + what,
                             .found = found,
                             .expected = expected,
                             .advice = "run it without --engine"});
}

void expect_possible(const scene::SceneSettings& s) {
  refuse(s.collisions != "helscm", "these collisions", s.collisions, "effects.collisions = \"helscm\"");
  refuse(s.gas == "coupled", "a gas that answers", s.gas, "gas.model = \"none\", \"uniform\" or \"frozen\"");
  refuse(s.needs_grid(), "drag that asks for the voidage", s.drag,
         "effects.drag = \"stokes\" or \"schiller_naumann\"");
  refuse(!s.outlets.empty(), "outlets", s.outlets.empty() ? "" : s.outlets[0], "walls and periodic sides");
  refuse(s.has_parcels(), "parcels", "parcels of spheres", "parcels = 1");
  for (const auto& g : s.groups)
    refuse(g.over > 0, "inlets", "group '" + g.group + "'", "all spheres at the start");
}

}  // namespace

class Processes::Impl {
 public:
  scene::MakeMover movers() {
    return [this](const scene::Domain& domain, const scene::MoverSettings& settings) {
      return make_shared_mover(job, domain, settings);
    };
  }
  Job job;
};

Processes::Processes() : impl_(std::make_unique<Impl>()) {}

Processes::~Processes() {
  if (impl_->job.leads()) impl_->job.order(Order::end, 0);
}

int Processes::rank() const { return impl_->job.rank(); }
int Processes::size() const { return impl_->job.size(); }

scene::MakeMover Processes::movers(const scene::SceneSettings& settings) {
  expect_possible(settings);
  return [this, text = to_toml(settings), folder = settings.folder.string()](const auto& domain,
                                                                             const auto& of_mover) mutable {
    impl_->job.order(Order::begin, 0);
    impl_->job.broadcast(text);
    impl_->job.broadcast(folder);
    return impl_->movers()(domain, of_mover);
  };
}

void Processes::serve() {
  std::unique_ptr<scene::Simulation> simulation;
  const auto begin = [&] {
    std::string text, folder;
    impl_->job.broadcast(text);
    impl_->job.broadcast(folder);
    auto settings = scene::parse_scene(text, "scene");
    settings.folder = folder;
    simulation = std::make_unique<scene::Simulation>(settings, 1, impl_->movers());
  };
  try {
    for (;;) {
      const auto order = impl_->job.order(Order::end, 0);
      if (order == Order::end) return;
      if (order == Order::begin) begin();
      if (order == Order::step) simulation->step();
      if (order == Order::gather) simulation->gather();
    }
  } catch (const std::exception& error) {
    impl_->job.abort(error.what());
  }
}

}  // namespace elrom::lammps
