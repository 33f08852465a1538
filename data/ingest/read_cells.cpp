#include "el3d.hpp"
#include "elrom/base/error.hpp"
#include "elrom/foam/foam_file.hpp"
#include "elrom/ingest/case_files.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/ingest/own_mesh.hpp"
#include "elrom/io/hdf5.hpp"
#include "foam_cells.hpp"
#include "vtu.hpp"

namespace elrom::ingest {
namespace {

namespace fs = std::filesystem;

CellSet read_folder(const fs::path& path) {
  for (const auto& folder : {path / "constant" / "polyMesh", path / "polyMesh", path})
    if (foam::FoamFile::exists(folder / "owner")) return read_poly_cells(folder);
  throw InputError({.what = "folder holds no mesh",
                    .where = path.string(),
                    .expected = "an OpenFOAM case, or its polyMesh with points, faces, owner and neighbour"});
}

CellSet read_centres(const fs::path& path) {
  CellSet cells;
  const auto read = [&] {
    CfdCase one;
    read_el3d_mesh(io::Hdf5File::open(path), one);
    cells.centre = std::move(one.centre);
    cells.volume = std::move(one.volume);
  };
  io::survive(path, "mesh", read);
  read();
  return cells;
}

}  // namespace

CellSet read_cells(const fs::path& path) {
  if (fs::is_directory(path)) return read_folder(path);
  if (path.extension() == ".vtu") return read_vtu(path);
  if (is_hdf5(path)) return read_centres(path);
  auto table = read_fluent_ascii(path);
  return {.centre = std::move(table.centre), .volume = std::move(table.volume)};
}

}  // namespace elrom::ingest
