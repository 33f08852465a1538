#include "onto_options.hpp"

#include "elrom/base/comma_list.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/cli/cli.hpp"

namespace elrom::fields {
namespace {

std::map<std::string, std::string> names_of(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> names;
  for (const auto& text : texts) {
    const auto sides = base::split(text, '=');
    if (sides.size() != 2 || base::trim(sides[0]).empty() || base::trim(sides[1]).empty()) {
      throw UsageError({.what = "--names cannot be read",
                        .found = "'" + text + "'",
                        .expected = "field=name, such as solid_velocity_x=phase-2-x-velocity"});
    }
    const auto name = base::trim(sides[1]);
    if (name.find_first_of(" \t") != std::string::npos)
      throw UsageError(
          {.what = "--names cannot be read", .found = "'" + name + "'", .expected = "a name without blanks"});
    names[base::trim(sides[0])] = name;
  }
  return names;
}

void check_time(const std::string& time) {
  const auto value = base::to_double(time);
  if (value && *value >= 0) return;
  throw UsageError({.what = "--time cannot be a time folder's name",
                    .found = "'" + time + "'",
                    .expected = "a number such as 0 or 12.5"});
}

void check_foam(const Arguments& arguments) {
  if (arguments.onto.mesh.empty()) throw UsageError("--format openfoam needs a case to start: --onto CASE");
  if (!std::filesystem::is_directory(arguments.onto.mesh)) {
    throw UsageError({.what = "--format openfoam needs a case to start",
                      .where = arguments.onto.mesh.string(),
                      .expected = "the folder of an OpenFOAM case"});
  }
  if (!arguments.fields.empty())
    throw UsageError("--format openfoam writes all fields that a start needs; leave out --fields");
  check_time(arguments.onto.time);
}

}  // namespace

void add_onto_options(cli::App& app, OntoOptions& options, OntoTexts& texts) {
  app.add_option("--onto", options.mesh,
                 "write .ip and openfoam on this mesh: an OpenFOAM case, or a file of cell centres "
                 "(.csv with x, y, z; .h5 with /mesh/centre)");
  app.add_option("--interpolation", texts.interpolation,
                 "conservative: means over the parts of cells that overlap, keeps the solids; trilinear: "
                 "smooth, between cells")
      ->check(cli::IsMember({"conservative", "trilinear"}))
      ->capture_default_str();
  base::comma_list(app.add_option("--names", texts.names, "field=name,...: names in .ip files"));
  app.add_option("--time", options.time, "openfoam: name of the time folder")->capture_default_str();
  app.add_option("--parcels", options.n_parcels,
                 "openfoam: number of parcels; default: as the case's cloud has, else 10000")
      ->check(cli::Range(std::size_t{1}, std::size_t{1'000'000'000}));
  app.add_option(
         "--parcel-spread", options.parcel_spread,
         "openfoam: standard deviation of ln d over all parcels; 0: every parcel has its cell's diameter")
      ->check(cli::Range(0.0, 2.0))
      ->capture_default_str();
  app.add_flag("--overwrite", options.overwrite, "openfoam: replace a time folder that is there");
}

void finish_onto_options(Arguments& arguments, const OntoTexts& texts) {
  arguments.onto.interpolation =
      texts.interpolation == "trilinear" ? Interpolation::trilinear : Interpolation::conservative;
  arguments.onto.names = names_of(texts.names);
  const bool foam = arguments.writes(Format::openfoam), fluent = arguments.writes(Format::ip);
  if (foam) check_foam(arguments);
  if (!arguments.onto.names.empty() && !fluent) throw UsageError("--names renames fields of --format ip");
  if (arguments.onto.mesh.empty()) return;
  if (!foam && !fluent) throw UsageError("--onto is for --format ip and openfoam");
  if (arguments.region || !arguments.planes.all())
    throw UsageError("--onto needs all cells; leave out --planes and --region");
  if (arguments.level) throw UsageError("--onto has no half-widths; leave out --uncertainty");
}

}  // namespace elrom::fields
