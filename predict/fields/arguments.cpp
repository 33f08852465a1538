#include "elrom/fields/arguments.hpp"

#include "elrom/base/comma_list.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/cli/cli.hpp"
#include "elrom/fields/ranges.hpp"
#include "onto_options.hpp"

namespace elrom::fields {
namespace {

constexpr const char* description = R"(
Predicts the fields of a furnace from its boundary conditions, with a bundle that elrom-train wrote.

  elrom-predict --bundle model.elrom --cases cases.csv --output results
  elrom-predict --bundle model.elrom --cases cases.csv --case load_064 --set 'primary_air=180 kg/s' --output results
  elrom-predict --bundle model.elrom --cases cases.csv --case load_064 --sweep primary_air=150:200:5 --output results
  elrom-predict --bundle model.elrom --cases cases.csv --case load_064 --fields pressure --format csv --output -
)";

constexpr const char* footer = R"(
Cases: a CSV table with the columns case, load (may be missing) and 'name [unit]' for every input, in any order; or
JSON or TOML with the same names; - reads a CSV table from standard input. Units are converted; without one a number is
in the unit that the bundle was trained with. Spreadsheets' semicolons and decimal commas are understood. --set changes an
input of every case chosen, and the changed case gets a name of its own (load_064+primary_air=180, or --name); without
--cases it must give all inputs. --sweep predicts every case chosen as it is, and once for every value of an input;
several --sweep: one input at a time, with --grid every combination. All other inputs are held at the base's values: an
input that does not move alone in a furnace may leave what was trained, and the gas balance then tells of the
combination that was asked for. Summary and page say where that is so.

Summary: when sweeping, or with --summary FILE.csv, a table with a line a case: verdict and reason, solids [kg], gas balance and
pressure drop as far as fields and furnace tell, mean, lowest and highest value of each field, and the change of each
against the case that it was made from. --page FILE.html draws it as curves over the swept inputs.

Validity: every case is judged inside, edge or outside of what the bundle was trained on, input by input (against the
trained range, and against what its other inputs make usual) and as a whole; the verdict and its reason are printed and
kept in the output (100 cases or more: counts are printed, lines with --verbose). Impossible inputs are refused: mass flows
and masses below 0, fractions outside 0 to 1, sizes, densities and absolute temperatures that are not above 0, and
whatever lies beyond every furnace. Inputs beyond one trained width outside the range are held there. With --strict a
case that is outside is not written, the other cases are, and the exit status is 4.

Physics: --audit compares what is written with the boundary conditions: solids in the fields against the inventory, gas
flow of every plane against the inlets' (mean and worst plane), net solid flow, pressure drop against the weight of the
solids, bounds. Numbers of every plane are in the .hdf file (/elrom/audit). --conserve brings the solids to the
inventory (input solids_inventory) and the gas flow of the planes between inlets and outlet to the inlets', by the
smallest change of volume fraction (in proportion to it) and of gas velocity z, and says how large it was; half-widths
stay as they are. EL3D's own averages do not conserve exactly: repaired fields are for users who need the balance, not
nearer to EL3D. Both need all planes and no region; of --fields, solid_volume_fraction and gas_velocity_z, and for
--audit pressure and solid_velocity_z too.

Output: <folder>/<case>.hdf (HDF5: /elrom for scripts, /VTKHDF for ParaView 5.11 and later), .csv, .txt (columns for
SFW3D) or .ip (Fluent interpolation file). Values are in SI. A file appears whole or not at all.

Another mesh: --onto CASE --format openfoam makes the start of an OpenFOAM run (MPPICFoam v1912) on the case's own mesh:
<folder>/<case>/<time>, or <folder>/<time> where --output is CASE itself. It holds U, p, alpha and the solids' parcels;
boundary conditions and all other fields are those of the case's latest time folder. A time folder that is there is left
alone unless --overwrite says so. --onto with --format ip writes the values at that mesh's cell centres. What the
interpolation changed of the solids is printed.

Exit status: 0 done, 2 wrong command line, 3 wrong file or input, 4 outside the trained range (--strict), 5 arithmetic.
)";

/// The text between a raw string's first and last line break, so that it can begin on a line of its own.
std::string lines_of(std::string_view raw) { return std::string(raw.substr(1, raw.size() - 2)); }

std::vector<std::string> format_names(bool text_only) {
  std::vector<std::string> names;
  for (const auto& info : formats())
    if (info.write != nullptr || !text_only) names.emplace_back(info.name);
  return names;
}

/// What is read as text, and understood when all of the command line is there.
struct Texts {
  std::string planes, region, builds = "mean";
  std::vector<std::string> formats;
  OntoTexts onto;
};

void add_input_options(cli::App& app, Arguments& arguments) {
  app.add_option("--bundle", arguments.bundle, "bundle to predict with")->required();
  app.add_option("--cases", arguments.cases, "table of cases: .csv, .json or .toml, or - for standard input");
  base::comma_list(app.add_option("--case", arguments.case_patterns,
                                  "only the cases of these names ('load_*' works), default: all"));
  base::repeatable(app.add_option("--set", arguments.settings,
                                  "name=value or 'name=value unit': an input's value; may be repeated"));
  app.add_option("--name", arguments.name, "name of the case that --set makes");
  base::repeatable(app.add_option("--sweep", arguments.sweeps,
                                  "name=start:stop:step or 'name=start:stop:step unit'; may be repeated"));
  app.add_flag("--grid", arguments.grid, "every combination of the sweeps");
}

void add_selection_options(cli::App& app, Arguments& arguments, Texts& texts) {
  base::comma_list(app.add_option("--fields", arguments.fields, "only these fields (a,b,c), default: all"));
  app.add_option("--planes", texts.planes, "only these planes: 7, 0:10 (without 10) or 0:10,20,30:")
      ->type_name("RANGES");
  app.add_option("--region", texts.region,
                 "only cells with centres in x0:x1,y0:y1,z0:z1 [m]; a side may be empty (:,:,0:5)")
      ->type_name("BOX");
  app.add_option(
         "--builds", texts.builds,
         "mean: combine builds as trained; best: one build alone, that of the least validation error, faster")
      ->check(cli::IsMember({"mean", "best"}))
      ->capture_default_str();
  app.add_option("--uncertainty", arguments.level,
                 "half-widths of prediction intervals of this level, such as 0.9")
      ->type_name("LEVEL");
  app.add_flag("--profile", arguments.profile, "only the plane averages (weighted by volume)");
}

void add_output_options(cli::App& app, Arguments& arguments, Texts& texts) {
  app.add_option("--output", arguments.output,
                 "folder to write to (made when missing), or - for standard output")
      ->capture_default_str();
  base::comma_list(app.add_option("--format", texts.formats,
                                  base::join(format_names(false), ", ") +
                                      "; several with commas; default: hdf, with --output -: csv"))
      ->type_name("FORMAT");
  app.add_option("--summary", arguments.summary,
                 "table with a line a case; default when sweeping: summary.csv in the folder")
      ->type_name("FILE.csv");
  app.add_option("--page", arguments.page, "curves over the swept inputs, for a browser")
      ->type_name("FILE.html");
  app.add_flag("--verbose", arguments.verbose, "a line for every case, however many there are");
  app.add_flag("--strict", arguments.strict,
               "do not write cases that are outside the trained range; exit status 4");
}

void add_physics_options(cli::App& app, Arguments& arguments) {
  app.add_flag("--audit", arguments.audit,
               "print and keep each case's physics audit (see below); needs all cells");
  app.add_flag("--conserve", arguments.conserve,
               "change each case as little as possible until solids and gas are conserved; needs all cells");
}

void add_run_options(cli::App& app, Arguments& arguments, bool& no_verify, bool& no_sync) {
  app.add_option("--threads", arguments.n_threads, "number of threads, 0: all processors")
      ->check(cli::Range(0, 1024))
      ->capture_default_str();
  app.add_flag("--no-verify", no_verify, "do not compare the bundle's digests (saves a few milliseconds)");
  app.add_flag("--no-sync", no_sync,
               "do not wait until files are on the disk (saves some ms a file; a power cut may lose them)");
  app.add_flag("--timing", arguments.timing,
               "print where the time went; one step after the other, so the whole takes a little longer");
}

void check_output(const Arguments& arguments) {
  std::error_code unreadable;  // is told when it is written to
  const bool there = std::filesystem::exists(arguments.output, unreadable);
  if (there && !std::filesystem::is_directory(arguments.output, unreadable) &&
      !arguments.to_standard_output())
    throw UsageError({.what = "--output is a file, not a folder",
                      .found = "'" + arguments.output + "'",
                      .advice = "name a folder; one case of a text format into a file: --output - > FILE"});
}

void check_what_if(Arguments& arguments) {
  if (arguments.grid && arguments.sweeps.empty()) throw UsageError("--grid needs --sweep");
  if (!arguments.page.empty() && arguments.sweeps.empty())
    throw UsageError("--page draws curves over what is swept; add --sweep");
  const bool beside_output = !arguments.sweeps.empty() && !arguments.to_standard_output();
  if (arguments.summary.empty() && beside_output)
    arguments.summary = std::filesystem::path(arguments.output) / "summary.csv";
}

void check_together(Arguments& arguments) {
  if (arguments.formats.empty())
    arguments.formats = {arguments.to_standard_output() ? Format::csv : Format::hdf};
  std::vector<Format> once;
  for (const auto format : arguments.formats) {
    if (std::find(once.begin(), once.end(), format) == once.end()) once.push_back(format);
  }
  arguments.formats = std::move(once);
  check_what_if(arguments);
  if (arguments.cases.empty() && arguments.settings.empty()) {
    throw UsageError("nothing to predict; give --cases FILE, or every input by --set name=value");
  }
  if (arguments.cases.empty() && !arguments.case_patterns.empty())
    throw UsageError("--case chooses from --cases FILE");
  const bool one_text = arguments.formats.size() == 1 && info_of(arguments.formats[0]).write != nullptr;
  if (arguments.to_standard_output() && !one_text)
    throw UsageError("--output - takes one text format: --format " + base::join(format_names(true), ", "));
  for (const auto format : arguments.formats)
    if (arguments.profile && !info_of(format).profiles)
      throw UsageError(std::string("--format ") + info_of(format).name + " holds cells; --profile has none");
}

}  // namespace

ParsedArguments parse_arguments(int argc, const char* const* argv) {
  Arguments arguments;
  Texts texts;
  bool no_verify = false, no_sync = false;
  cli::App app(lines_of(description) + "\n", "elrom-predict");
  app.set_version_flag("--version", program_version());
  app.footer(lines_of(footer));
  app.column_width(24);
  add_input_options(app, arguments);
  add_selection_options(app, arguments, texts);
  add_output_options(app, arguments, texts);
  add_onto_options(app, arguments.onto, texts.onto);
  add_physics_options(app, arguments);
  add_run_options(app, arguments, no_verify, no_sync);
  if (const auto status = app.parse(argc, argv)) return {.arguments = {}, .exit_status = status};
  if (!texts.planes.empty()) arguments.planes = parse_planes(texts.planes);
  if (!texts.region.empty()) arguments.region = parse_box(texts.region);
  for (const auto& name : texts.formats) arguments.formats.push_back(format_named(name).format);
  finish_onto_options(arguments, texts.onto);
  arguments.best_build_only = texts.builds == "best";
  arguments.verify = !no_verify;
  arguments.sync = !no_sync;
  check_output(arguments);
  check_together(arguments);
  return {.arguments = std::move(arguments), .exit_status = {}};
}

}  // namespace elrom::fields
