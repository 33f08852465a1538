#include <atomic>

#include "desk.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/shell.hpp"
#include "elrom/base/text.hpp"
#include "tar.hpp"

namespace elrom::serve {
namespace {

using repository::Role;
namespace fs = std::filesystem;

struct FileKind {
  const char *name, *media;
};
constexpr FileKind kinds[] = {{"hdf", "application/x-hdf5"},
                              {"csv", "text/csv"},
                              {"txt", "text/plain"},
                              {"ip", "text/plain"},
                              {"openfoam", "application/x-tar"}};

/// A folder that is gone at the end.
class Folder {
 public:
  explicit Folder(const fs::path& parent) {
    static std::atomic<int> counter{0};
    path_ = parent / ("files." + std::to_string(counter++));
    fs::remove_all(path_);  // what a killed server left
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const FileKind& kind_in(const JsonBody& body, const Desk& desk) {
  const auto name = body.text("format");
  const auto offered = file_formats(desk);
  if (std::ranges::find(offered, name) != offered.end())
    return *std::ranges::find(kinds, name, [](const FileKind& kind) { return std::string(kind.name); });
  throw InputError(
      Problem{.what = "no such format here",
              .found = "'" + name + "'",
              .expected = base::join(offered, ", "),
              .advice = name == "openfoam" ? "elrom-serve --openfoam-case CASE starts that case" : ""});
}

std::vector<std::string> command_of(const Desk& desk, const OpenModel& model, const fs::path& folder,
                                    const std::string& format, bool intervals) {
  std::vector<std::string> command{desk.options.predict_program.string(),
                                   "--bundle",
                                   model.file().string(),
                                   "--cases",
                                   (folder / "case.json").string(),
                                   "--output",
                                   (folder / "out").string(),
                                   "--format",
                                   format};
  if (format == "openfoam") command.insert(command.end(), {"--onto", desk.options.openfoam_case.string()});
  // Fluent and OpenFOAM know no intervals.
  if (intervals && model.has_intervals() && format != "openfoam" && format != "ip")
    command.insert(command.end(), {"--uncertainty", base::number(OpenModel::level)});
  return command;
}

/// The file of the one case, or its time folder as an archive, to be unpacked in the OpenFOAM case.
std::string written(const fs::path& out) {
  const auto only = [](const fs::path& folder) { return fs::directory_iterator(folder)->path(); };
  const auto one = only(out);
  return fs::is_directory(one) ? tar_of(only(one)) : base::read_text(one);
}

http::Response file(Desk& desk, const Ask& ask) {
  constexpr double patience_s = 120;
  const auto model = open_model(desk);
  const JsonBody body(ask.request.body, {"case", "load", "inputs", "format", "intervals"});
  const auto& kind = kind_in(body, desk);
  const auto judged = judge_case(body, *model);
  const Folder folder(desk.options.repository.folder / "outgoing");
  // The file is named by us: a case's name may be anything.
  Json one{{"case", "prediction"}, {"inputs", Json::parse(judged.document)}};
  if (body.has("load")) one["load"] = body.number("load");
  base::write_text(folder.path() / "case.json", one.dump());
  const auto ended =
      base::run_program(command_of(desk, *model, folder.path(), kind.name, body.flag_or("intervals", true)),
                        {.listen = true, .seconds = patience_s});
  if (!ended.well())
    throw InputError(Problem{.what = "elrom-predict did not write the file", .found = ended.reason()});
  const std::string ending = kind.name == std::string("openfoam") ? "tar" : kind.name;
  return {.headers = {{"Content-Type", kind.media},
                      {"Cache-Control", "no-store"},
                      {"Content-Disposition", "attachment; filename=\"prediction." + ending + "\""}},
          .body = written(folder.path() / "out")};
}

}  // namespace

std::vector<std::string> file_formats(const Desk& desk) {
  std::vector<std::string> names;
  if (desk.options.predict_program.empty()) return names;
  for (const auto& kind : kinds)
    if (kind.name != std::string("openfoam") || !desk.options.openfoam_case.empty())
      names.emplace_back(kind.name);
  return names;
}

std::vector<Route> file_routes() {
  return {
      {.method = "POST",
       .path = "/predictions/file",
       .role = Role::reader,
       .summary =
           "A prediction as elrom-predict writes it: hdf, csv, txt, ip, or a tar of an OpenFOAM time folder",
       .answers = {{200, "the file"}, {404, "there is no model yet"}},
       .answer = file,
       .body = BodyKind::json,
       .example = R"({"load": 1.0, "inputs": {}, "format": "csv", "intervals": true})",
       .wrong = R"({"inputs": {}, "format": "stone"})",
       .required = {"inputs", "format"},
       .media = {"application/x-hdf5", "text/csv", "text/plain", "application/x-tar"}}};
}

}  // namespace elrom::serve
