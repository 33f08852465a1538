#include "elrom/masters/foreign_program.hpp"

#include <unistd.h>

#include <cstdlib>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/csv.hpp"
#include "elrom/io/settings_table.hpp"

namespace elrom::masters {
namespace {

/// As the file has it; folders are relative to it.
struct Described : ForeignProgram {
  std::string template_folder;
};

io::SettingsTable<Described> described_table() {
  constexpr double a_year_s = 366 * 86400.0;
  io::SettingsTable<Described> t;
  t.word(
       "name", "for people and results", [](auto& p) -> auto& { return p.name; })
      .require();
  t.word(
       "templates", "folder that is copied for each run", [](auto& p) -> auto& { return p.template_folder; })
      .require();
  t.word(
       "command", "for /bin/sh, in the copy", [](auto& p) -> auto& { return p.command; })
      .require();
  t.words(
      "needs", "programs that must be there", [](auto& p) -> auto& { return p.needs; });
  t.word(
      "install", "how they come there", [](auto& p) -> auto& { return p.install; });
  t.real(
      "time_limit_s", "after which it is ended", [](auto& p) -> auto& { return p.time_limit_s; }, 1,
      a_year_s);
  t.word(
      "case", "what it leaves: a CFD case", [](auto& p) -> auto& { return p.cfd_case; });
  t.word(
      "document", "what it leaves: a JSON file", [](auto& p) -> auto& { return p.document; });
  return t;
}

bool is_executable(const std::filesystem::path& file) { return ::access(file.c_str(), X_OK) == 0; }

bool is_found(const std::string& program) {
  if (program.find('/') != std::string::npos) return is_executable(program);
  const char* path = std::getenv("PATH");
  for (const auto& folder : base::split(path == nullptr ? "" : path, ':'))
    if (!folder.empty() && is_executable(std::filesystem::path(folder) / program)) return true;
  return false;
}

}  // namespace

ForeignProgram read_foreign_program(const std::filesystem::path& file) {
  Described described;
  described_table().read(described, io::parse_settings(io::read_small_text(file), file.string()));
  ForeignProgram program = described;
  program.templates = std::filesystem::absolute(file).parent_path() / described.template_folder;
  if (std::filesystem::is_directory(program.templates)) return program;
  throw UsageError(Problem{.what = "no folder of templates",
                           .where = file.string(),
                           .found = program.templates.string(),
                           .expected = "a folder, relative to this file"});
}

void expect_installed(const ForeignProgram& program) {
  for (const auto& name : program.needs)
    if (!is_found(name))
      throw SystemError(Problem{.what = name + " is not installed",
                                .where = program.name,
                                .advice = program.install + (program.install.empty() ? "" : "; ") +
                                          "its runs wait until it is there"});
}

}  // namespace elrom::masters
