#include "elrom/foam/foam_case.hpp"

#include <fcntl.h>
#include <stdio.h>

#include <algorithm>
#include <array>
#include <vector>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/foam/foam_file.hpp"
#include "elrom/foam/foam_text.hpp"

namespace elrom::foam {
namespace {

namespace fs = std::filesystem;

constexpr const char* mppic_cloud = "kinematicCloud";

/// `file` without the ending .gz.
std::string plain_name(const fs::path& file) {
  return file.extension() == ".gz" ? file.stem().string() : file.filename().string();
}

/// What stands behind "U." in a time folder; nothing for a folder with U alone.
std::optional<std::string> gas_in(const fs::path& folder) {
  if (FoamFile::exists(folder / "U")) return "";
  std::vector<std::string> phases;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto name = plain_name(entry.path());
    if (entry.is_regular_file() && name.starts_with("U.")) phases.push_back(name.substr(2));
  }
  if (phases.size() > 1) {
    std::sort(phases.begin(), phases.end());
    throw InputError({.what = "cannot tell which phase is the gas",
                      .where = folder.string(),
                      .found = "U." + base::join(phases, ", U."),
                      .advice = "name it in constant/transportProperties: continuousPhase"});
  }
  return phases.empty() ? std::nullopt : std::optional(phases.front());
}

std::optional<FoamFile> open_if_there(const fs::path& path) {
  return FoamFile::exists(path) ? std::optional<FoamFile>(FoamFile(path)) : std::nullopt;
}

/// Fills in the gas, where the case names it, and the latest time folder with its velocity.
void find_fields(FoamCase& found, const std::optional<std::string>& named) {
  double latest = -1;
  for (const auto& entry : fs::directory_iterator(found.directory)) {
    const auto time = base::to_double(entry.path().filename().string());
    if (!entry.is_directory() || !time || !(*time > latest)) continue;
    const auto gas = named && FoamFile::exists(entry.path() / ("U." + *named)) ? named : gas_in(entry.path());
    if (!gas) continue;
    latest = *time;
    found.fields = entry.path();
    found.gas = *gas;
  }
  if (latest >= 0) return;
  throw InputError({.what = "no time folder with a gas velocity",
                    .where = found.directory.string(),
                    .expected = "one (such as 0) with U or U.<gas>, whose boundary conditions are taken"});
}

/// Exponents of kg, m, s.
std::array<double, 3> dimensions_of(FoamFile& file) {
  file.seek_required("dimensions");
  file.expect("[");
  std::array<double, 3> exponents{};
  for (auto& exponent : exponents) exponent = file.number();
  return exponents;
}

std::optional<double> density_for(const FoamCase& found, std::optional<FoamFile>& properties) {
  FoamFile pressure(found.fields / "p");
  const auto unit = dimensions_of(pressure);
  if (unit == std::array<double, 3>{1, -1, -2}) return std::nullopt;
  if (unit != std::array<double, 3>{0, 2, -2})
    pressure.fail("other dimensions", "p in Pa, [1 -1 -2 ...], or over the density, [0 2 -2 ...]");
  for (const auto& name : {found.with_gas("rho"), std::string("rho")})
    if (properties && properties->seek(name)) return properties->dictionary_number(name);
  throw InputError({.what = "the case's p is kinematic, and the density of its gas is not known",
                    .where = (found.directory / "constant" / "transportProperties").string(),
                    .expected = found.with_gas("rho")});
}

/// Clouds that the folder or the case's properties name.
std::string cloud_of(const FoamCase& found) {
  std::vector<std::string> names;
  if (fs::is_directory(found.fields / "lagrangian")) {
    for (const auto& entry : fs::directory_iterator(found.fields / "lagrangian"))
      if (entry.is_directory()) names.push_back(entry.path().filename().string());
  }
  const std::string ending = "CloudProperties";
  for (const auto& entry : fs::directory_iterator(found.directory / "constant")) {
    const auto name = plain_name(entry.path());
    if (name.ends_with(ending))
      names.push_back(name.substr(0, name.size() - std::string("Properties").size()));
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  if (names.empty()) return {};
  if (names.size() == 1) return names.front();
  if (std::find(names.begin(), names.end(), mppic_cloud) != names.end()) return mppic_cloud;
  throw InputError({.what = "cannot tell the solids' cloud",
                    .where = found.directory.string(),
                    .found = base::join(names, ", "),
                    .expected = std::string("one, or one named ") + mppic_cloud});
}

/// The number behind a word anywhere in a file.
std::optional<double> number_behind(FoamFile& file, std::string_view word) {
  file.to_body();
  while (!file.at_end())
    if (file.token() == word) return file.number();
  return std::nullopt;
}

void read_cloud(FoamCase& found) {
  found.cloud = cloud_of(found);
  if (found.cloud.empty()) return;
  if (auto properties = open_if_there(found.directory / "constant" / (found.cloud + "Properties")))
    found.solid_density = number_behind(*properties, "rho0");
  auto density = open_if_there(found.fields / "lagrangian" / found.cloud / "rho");
  if (!density) return;
  density->to_body();
  const auto n = density->list_size(0, 2);
  found.n_parcels = n;
  density->to_body();
  if (n > 0 && !found.solid_density) found.solid_density = density->scalars(n).front();
}

/// Writes the fields of one time folder into `folder`.
class TimeFolder {
 public:
  TimeFolder(const FoamCase& of, fs::path folder, std::string time, std::string note)
      : of_(of), folder_(std::move(folder)), time_(std::move(time)), note_(std::move(note)) {
    fs::create_directories(folder_);
  }
  void write(const std::string& name, const std::string& kind, const std::string& values) {
    FoamFile pattern(of_.fields / name);
    const auto class_name = pattern.class_name();
    base::write_text(folder_ / name,
                     header(class_name, time_, name, note_) +
                         pattern.body_with("internalField", "nonuniform List<" + kind + ">\n" + values));
    written_.push_back(name);
  }
  /// Fields of cells that nobody predicts, as they are.
  void copy_others() const {
    for (const auto& entry : fs::directory_iterator(of_.fields)) {
      const auto name = plain_name(entry.path());
      if (!entry.is_regular_file() || std::find(written_.begin(), written_.end(), name) != written_.end())
        continue;
      if (name.ends_with("_0") || name.find(':') != std::string::npos) continue;  // old times, a cloud's work
      if (FoamFile(of_.fields / name).class_name().starts_with("vol"))
        fs::copy_file(entry.path(), folder_ / entry.path().filename());
    }
  }

 private:
  const FoamCase& of_;
  fs::path folder_;
  std::string time_, note_;
  std::vector<std::string> written_;
};

std::vector<float> mapped(std::span<const float> values, auto&& function) {
  std::vector<float> result(values.size());
  std::transform(values.begin(), values.end(), result.begin(), function);
  return result;
}

/// Removed again unless it was put in its place.
struct Remains {
  fs::path folder;
  ~Remains() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

/// `folder` gets the name `target`; what had it gets the name `folder`, so that a kill at any moment leaves
/// one of the two whole under `target`. File systems that cannot exchange names lack it for a moment.
void put_in_place(const fs::path& folder, const fs::path& target) {
  if (::renameat2(AT_FDCWD, folder.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
  if (fs::exists(target)) fs::rename(target, folder.string() + ".old");
  const Remains replaced{folder.string() + ".old"};
  fs::rename(folder, target);
}

}  // namespace

FoamCase read_foam_case(const fs::path& directory) {
  if (!fs::is_directory(directory / "constant" / "polyMesh")) {
    throw InputError({.what = "no OpenFOAM case",
                      .where = directory.string(),
                      .expected = "a folder with constant/polyMesh"});
  }
  FoamCase found{.directory = directory};
  auto properties = open_if_there(directory / "constant" / "transportProperties");
  std::optional<std::string> named;
  if (properties && properties->seek("continuousPhase")) named = std::string(properties->token());
  find_fields(found, named);
  found.gas_density = density_for(found, properties);
  read_cloud(found);
  return found;
}

void write_time_folder(const FoamCase& of, const fs::path& target, const StartFields& start,
                       const std::vector<Parcel>& parcels, double solid_density, const std::string& note) {
  const auto time = target.filename().string();
  const Remains unfinished{base::temporary_beside(target)};
  TimeFolder folder(of, unfinished.folder, time, note);
  folder.write(of.with_gas("U"), "vector",
               list(start.gas_velocity_x, start.gas_velocity_y, start.gas_velocity_z));
  const auto density = static_cast<float>(of.gas_density.value_or(1));
  folder.write("p", "scalar", list(mapped(start.pressure, [&](float p) { return p / density; })));
  const auto alpha = of.with_gas("alpha");
  if (!of.gas.empty() && FoamFile::exists(of.fields / alpha)) {
    folder.write(alpha, "scalar",
                 list(mapped(start.solids.volume_fraction, [](float solids) { return 1 - solids; })));
  }
  folder.copy_others();
  if (!of.cloud.empty())
    write_cloud(unfinished.folder / "lagrangian" / of.cloud, parcels, solid_density, time, note);
  put_in_place(unfinished.folder, target);
}

}  // namespace elrom::foam
