#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "elrom/field/mesh.hpp"

namespace elrom::programs {

namespace {

struct MeshOptions {
  field::TaperedFurnace furnace;
  std::size_t n_x = 20, n_y = 42, n_planes = 66;
  std::filesystem::path output;
};

int run_mesh(const MeshOptions& options) {
  const auto mesh = field::make_furnace_mesh(options.furnace, options.n_x, options.n_y, options.n_planes);
  field::write_mesh(options.output, mesh);
  fmt::print("{}: {} planes x {} columns = {} cells, digest {}\n", options.output.string(), mesh.n_planes,
             mesh.n_columns, mesh.n_cells(), mesh.digest().substr(0, 12));
  return 0;
}

}  // namespace

void add_mesh(CLI::App& program, Work& chosen) {
  auto options = std::make_shared<MeshOptions>();
  auto* command = program.add_subcommand(
      "mesh",
      R"(Make a reduced mesh: horizontal planes of a furnace of rectangular cross-section whose lower part is tapered in x.
The defaults are the shipped furnace.)");
  const auto add = [&](const char* name, auto& value, const char* help) {
    command->add_option(name, value, help)->capture_default_str();
  };
  add("--nx", options->n_x, "Cells in x, front to rear");
  add("--ny", options->n_y, "Cells in y, left to right");
  add("--planes", options->n_planes, "Horizontal planes");
  add("--width", options->furnace.width_m, "Width in x above the taper [m]");
  add("--bottom-width", options->furnace.bottom_width_m, "Width in x at z = 0 [m]");
  add("--depth", options->furnace.depth_m, "Depth in y [m]");
  add("--height", options->furnace.height_m, "Height in z [m]");
  add("--taper-height", options->furnace.taper_height_m, "Height at which the taper ends [m]");
  command->add_option("--output", options->output, "Mesh file to write")->type_name("MESH.h5")->required();
  command->callback([options, &chosen] { chosen = [options] { return run_mesh(*options); }; });
}

}  // namespace elrom::programs
