#include "elrom/report/compare.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/model/bundle.hpp"
#include "evaluate_bundles.hpp"
#include "store_rows.hpp"

namespace elrom::report {
namespace {

namespace fs = std::filesystem;

// Of a bundle, the study it lies in: STUDY/model.elrom, or a folder below for versions and peers.
std::optional<fs::path> study_of(const fs::path& path) {
  if (fs::is_directory(path)) return path;
  const auto folder = fs::absolute(path).parent_path();
  for (const auto& candidate : {folder, folder.parent_path()})
    if (fs::exists(candidate / "split.json")) return candidate;
  return std::nullopt;
}

bool is_in(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::vector<std::string> trained_cases(const fs::path& bundle) {
  return model::BundleReader(bundle).info().cases;
}

StudyFiles files_of(const CompareOptions& options) {
  if (const auto folder = study_of(options.a)) return open_study(*folder, options.store);
  if (!options.store || options.cases.empty())
    throw UsageError({.what = "no study that says which cases to compare on",
                      .where = options.a.string(),
                      .advice = "name a study, or --store and --cases"});
  return {.directory = options.a.parent_path(),
          .store = *options.store,
          .settings = {},
          .name = options.a.string()};
}

/// Cases to judge on; those that A or B was trained on go to `left_out`.
std::vector<std::string> judging_cases(const CompareOptions& options, const std::vector<std::string>& wanted,
                                       const StudyFiles& files, std::vector<std::string>& left_out) {
  const auto a = trained_cases(files.bundles[0].path), b = trained_cases(files.bundles[1].path);
  std::vector<std::string> cases;
  for (const auto& name : wanted) {
    if (!is_in(a, name) && !is_in(b, name)) {
      cases.push_back(name);
      continue;
    }
    if (is_in(options.cases, name))
      throw UsageError(
          {.what = std::string(is_in(a, name) ? "A" : "B") + " was trained on case '" + name + "'",
           .where = (is_in(a, name) ? options.a : options.b).string(),
           .advice = "compare on cases that neither has seen"});
    left_out.push_back(name);
  }
  if (cases.empty())
    throw InputError({.what = "no case is left that neither A nor B was trained on",
                      .where = files.store.string(),
                      .found = base::join(left_out, ", "),
                      .advice = "name cases that neither has seen with --cases"});
  return cases;
}

void keep_common_fields(Comparison& comparison) {
  auto& report = comparison.report;
  const auto is_common = [](const FieldAccuracy& f) {
    return f.methods[0].available && f.methods[1].available;
  };
  std::vector<FieldAccuracy> fields;
  std::vector<FieldFigures> figures;
  for (std::size_t f = 0; f < report.fields.size(); ++f) {
    if (!is_common(report.fields[f])) {
      comparison.missing.push_back(report.fields[f].info.name);
      continue;
    }
    if (report.figures) figures.push_back(std::move(report.figures->fields[f]));
    fields.push_back(std::move(report.fields[f]));
  }
  report.fields = std::move(fields);
  if (report.figures) report.figures->fields = std::move(figures);
  if (report.fields.empty())
    throw InputError({.what = "A and B have no field in common", .where = comparison.b.string()});
}

void judge(Comparison& comparison) {
  const auto& fields = comparison.report.fields;
  const auto n = static_cast<double>(fields.size());
  for (const auto& field : fields) {
    comparison.fields.push_back(
        {field.info.name, field.nrmse(0), field.nrmse(1), relative_gain({&field, 1}, 1, 0)});
    comparison.mean.a += field.nrmse(0) / n;
    comparison.mean.b += field.nrmse(1) / n;
  }
  comparison.mean.gain = relative_gain(fields, 1, 0);
}

}  // namespace

Comparison compare(const CompareOptions& options, Log& log, const std::stop_token& stop) {
  auto files = files_of(options);
  auto a = open_other(options.a), b = open_other(options.b);
  a.name = "A";
  b.name = "B";
  files.bundles = {a, b};
  Comparison comparison{
      .report = {}, .a = options.a, .b = options.b, .fields = {}, .mean = {}, .left_out = {}, .missing = {}};
  {
    const auto store = field::SnapshotStore::open(files.store);
    const auto wanted = options.cases.empty() ? files.held_out : named_cases(store, options.cases);
    files.held_out = judging_cases(options, wanted, files, comparison.left_out);
    files.building = trained_cases(a.path);  // by whose mean errors are measured, as in its study's report
  }
  if (!comparison.left_out.empty())
    log.warning("left out, since A or B was trained on them: " + base::join(comparison.left_out, ", "));
  comparison.report = evaluate_bundles(std::move(files), {options.n_threads, options.figures}, log, stop);
  keep_common_fields(comparison);
  judge(comparison);
  return comparison;
}

}  // namespace elrom::report
