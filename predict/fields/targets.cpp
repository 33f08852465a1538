#include "targets.hpp"

#include <cstdio>
#include <map>
#include <set>

#include "elrom/base/error.hpp"

namespace elrom::fields {
namespace {

void write_all(std::FILE* stream, const std::string& text, const std::string& where) {
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stream) == text.size() && std::fflush(stream) == 0;
  if (!written) throw SystemError({.what = "cannot write", .where = where, .advice = "is the disk full?"});
}

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  std::FILE* stream = std::fopen(path.c_str(), "wb");
  if (stream == nullptr) throw SystemError({.what = "cannot write", .where = path.string()});
  try {
    write_all(stream, text, path.string());
  } catch (...) {
    std::fclose(stream);
    throw;
  }
  if (std::fclose(stream) != 0)
    throw SystemError({.what = "cannot write", .where = path.string(), .advice = "is the disk full?"});
}

}  // namespace

Targets::Targets(const Arguments& arguments)
    : folder_(arguments.output), time_(arguments.onto.time), sync_(arguments.sync) {
  std::error_code not_there;
  in_case_ = !arguments.onto.mesh.empty() &&
             std::filesystem::equivalent(folder_, arguments.onto.mesh, not_there) && !not_there;
}

void Targets::prepare(const Arguments& arguments, const std::vector<field::CaseInputs>& cases) const {
  for (const auto& file : {arguments.summary, arguments.page})
    if (!file.empty()) base::expect_writable(file);
  if (arguments.to_standard_output()) return;
  std::filesystem::create_directories(folder_);
  std::map<std::filesystem::path, std::set<std::string, std::less<>>> names;  // by folder
  for (const auto& inputs : cases) {
    for (const auto format : arguments.formats) {
      const auto target = path(format, inputs);
      names[target.parent_path()].insert(target.filename().string());
    }
  }
  for (const auto& [folder, targets] : names)
    base::remove_dead_remains(folder, [&](std::string_view name) { return targets.contains(name); });
}

std::filesystem::path Targets::path(Format format, const field::CaseInputs& inputs) const {
  if (format == Format::openfoam) return in_case_ ? folder_ / time_ : folder_ / inputs.name / time_;
  return folder_ / (inputs.name + "." + info_of(format).name);
}

std::unique_ptr<base::AtomicFile> Targets::begin(Format format, const field::CaseInputs& inputs) const {
  return std::make_unique<base::AtomicFile>(path(format, inputs),
                                            sync_ ? base::Sync::content : base::Sync::none);
}

void Targets::write(Format format, const field::CaseInputs& inputs, const std::string& text) const {
  const auto file = begin(format, inputs);
  write_text_file(file->temporary(), text);
  file->commit();
}

void write_to_standard_output(const std::string& text) { write_all(stdout, text, "standard output"); }

}  // namespace elrom::fields
