#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "elrom/base/log.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/ingest/own_mesh.hpp"

namespace elrom::programs {

namespace {

struct MeshOptions {
  field::TaperedFurnace furnace;
  std::size_t n_x = 20, n_y = 42, n_planes = 66;
  std::filesystem::path source, output;
  std::string along = "z";
  std::optional<double> tolerance_m;
};

int write(const MeshOptions& options, const field::Mesh& mesh) {
  field::write_mesh(options.output, mesh);
  fmt::print("{}: {} plane{} x {} columns = {} cells, digest {}\n", options.output.string(), mesh.n_planes,
             mesh.n_planes == 1 ? "" : "s", mesh.n_columns, mesh.n_cells(), mesh.digest().substr(0, 12));
  return 0;
}

int make_furnace(const MeshOptions& options) {
  return write(options,
               field::make_furnace_mesh(options.furnace, options.n_x, options.n_y, options.n_planes));
}

int take_cells(const MeshOptions& options, const std::optional<std::size_t>& n_planes) {
  const auto log = make_console_log();
  const ingest::Grouping grouping{.axis = static_cast<int>(std::string("xyz").find(options.along)),
                                  .n_planes = n_planes,
                                  .tolerance_m = options.tolerance_m};
  const auto own =
      ingest::group_into_planes(ingest::read_cells(options.source), grouping, options.source.string());
  if (!own.layered && !n_planes)
    log->info("no planes of equally many cells along " + options.along + ": all cells are one plane");
  if (!own.has_corners) log->info("only centres are known: predictions show cells as points");
  if (!own.has_volumes) log->info("no volumes are known: every cell counts alike");
  return write(options, own.mesh);
}

}  // namespace

void add_mesh(cli::App& program, Work& chosen) {
  auto options = std::make_shared<MeshOptions>();
  auto* command = program.add_subcommand(
      "mesh",
      R"(Make a reduced mesh. From SOURCE: its own cells, in planes of equally many where it is layered, else as one plane:
  an OpenFOAM case or its polyMesh, a .vtu file, an HDF5 file with /mesh/centre, or a table of cell centres
  (columns x, y, z and, where known, volume).
Without SOURCE: horizontal planes of a furnace of rectangular cross-section whose lower part is tapered in x; the defaults are
the shipped furnace.)");
  auto* source = command->add_option("SOURCE", options->source, "Mesh or cell centres to take");
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command->add_option(name, value, help)->capture_default_str();
  };
  add("--nx", options->n_x, "Cells in x, front to rear")->excludes(source);
  add("--ny", options->n_y, "Cells in y, left to right")->excludes(source);
  auto* planes =
      add("--planes", options->n_planes,
          "Horizontal planes; of SOURCE: as many as are found, or 1 to take all cells as one plane");
  add("--width", options->furnace.width_m, "Width in x above the taper [m]")->excludes(source);
  add("--bottom-width", options->furnace.bottom_width_m, "Width in x at z = 0 [m]")->excludes(source);
  add("--depth", options->furnace.depth_m, "Depth in y [m]")->excludes(source);
  add("--height", options->furnace.height_m, "Height in z [m]")->excludes(source);
  add("--taper-height", options->furnace.taper_height_m, "Height at which the taper ends [m]")
      ->excludes(source);
  add("--planes-along", options->along, "Axis of SOURCE that planes lie across; reports show planes along z")
      ->check(cli::IsMember({"x", "y", "z"}))
      ->needs(source);
  command
      ->add_option("--group-tolerance", options->tolerance_m,
                   R"(Cells of SOURCE whose coordinates differ by no more are one plane, or one row of it [m]
[default: 1e-5 of the mesh's extent along the axis])")
      ->check(cli::NonNegativeNumber)
      ->needs(source);
  command->add_option("--output", options->output, "Mesh file to write")->type_name("MESH.h5")->required();
  command->callback([options, planes, &chosen] {
    std::optional<std::size_t> n_planes;
    if (planes->count() > 0) n_planes = options->n_planes;
    chosen = [options, n_planes] {
      return options->source.empty() ? make_furnace(*options) : take_cells(*options, n_planes);
    };
  });
}

}  // namespace elrom::programs
