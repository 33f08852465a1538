#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/predictor.hpp"

namespace elrom::programs {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

struct RetrainArguments {
  StudyArguments study;
  std::filesystem::path json;
  bool compare = false, small = false;
};

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// Mean over fields of the NRMSE against the training mean, on cases that neither bundle was built with.
double held_out_error(const std::filesystem::path& bundle, const study::Study& study) {
  const model::Predictor predictor(bundle);
  const auto& rows = study.held_out();
  const MatrixD inputs = study.store().inputs(rows);
  const auto n_cells = static_cast<Eigen::Index>(study.store().mesh().n_cells());
  const auto building = study.store().find("*");
  std::vector<float> values(predictor.size());
  model::Predictor::Scratch scratch;
  std::map<std::string, double> error, spread;
  std::map<std::string, MatrixF> truth, mean;
  std::vector<std::size_t> built;
  for (const auto row : building)
    if (std::ranges::find(rows, row) == rows.end()) built.push_back(row);
  for (const auto& info : predictor.fields()) {
    truth[info.name] = study.store().read(info.name, rows);
    mean[info.name] = study.store().read(info.name, built).colwise().mean();
  }
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    predictor.predict({inputs.row(i).data(), static_cast<std::size_t>(inputs.cols())}, values, {}, scratch);
    for (std::size_t f = 0; f < predictor.fields().size(); ++f) {
      const auto& name = predictor.fields()[f].name;
      const ConstMapF predicted(values.data() + static_cast<Eigen::Index>(f) * n_cells, 1, n_cells);
      error[name] += (predicted - truth[name].row(i)).cast<double>().squaredNorm();
      spread[name] += (mean[name] - truth[name].row(i)).cast<double>().squaredNorm();
    }
  }
  double sum = 0;
  for (const auto& [name, squared] : error) sum += spread[name] > 0 ? std::sqrt(squared / spread[name]) : 0;
  return sum / static_cast<double>(error.size());
}

/// The same from the cross-validation that a bundle was chosen by, where a store holds no case out.
double cross_validated_error(const std::filesystem::path& bundle) {
  const auto accuracy = Json::parse(model::BundleReader(bundle).info().accuracy_json);
  double sum = 0;
  for (const auto& [field, entry] : accuracy.items()) sum += entry.value("nrmse", 1.0);
  return sum / static_cast<double>(std::max<std::size_t>(accuracy.size(), 1));
}

double error_of(const std::filesystem::path& bundle, const study::Study& study) {
  return study.held_out().empty() ? cross_validated_error(bundle) : held_out_error(bundle, study);
}

std::optional<double> recorded_seconds(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "timing.json")) return std::nullopt;
  const auto json = Json::parse(base::read_text(folder / "timing.json"), nullptr, false);
  if (!json.is_object() || !json.contains("from_nothing") || !json["from_nothing"].is_object())
    return std::nullopt;
  return json["from_nothing"].value("total_seconds", 0.0);
}

/// The same cases in a folder of its own, with nothing to reuse.
double seconds_from_nothing(const RetrainArguments& arguments, study::Settings settings,
                            const study::Toolbox& tools, Log& log) {
  const auto folder = arguments.study.folder / ".from_nothing";
  std::filesystem::remove_all(folder);
  settings.store = std::filesystem::absolute(std::filesystem::path(settings.store).is_absolute()
                                                 ? std::filesystem::path(settings.store)
                                                 : arguments.study.folder / settings.store)
                       .string();
  const auto begin = Clock::now();
  study::Study(folder, settings, tools, log, base::interrupt_token()).fit();
  const double seconds = since(begin);
  std::filesystem::remove_all(folder);
  return seconds;
}

Json retrain(const RetrainArguments& arguments, const study::Settings& settings, const study::Toolbox& tools,
             Log& log) {
  const auto& folder = arguments.study.folder;
  const auto current = folder / "model.elrom", candidate = folder / "candidate.elrom";
  if (!std::filesystem::exists(current)) {
    throw InputError({.what = "nothing to retrain",
                      .where = folder.string(),
                      .expected = "model.elrom",
                      .advice = "use elrom-train run first"});
  }
  const auto earlier = model::BundleReader(current).info().cases;
  auto from_nothing = recorded_seconds(folder);
  const auto begin = Clock::now();
  study::Study study(folder, settings, tools, log, base::interrupt_token());
  study.reuse_plans_of(earlier);
  study.fit(candidate);
  const double seconds = since(begin);
  const double before = error_of(current, study), after = error_of(candidate, study);
  const bool promoted = after <= before;
  if (promoted)
    std::filesystem::rename(candidate, current);
  else
    std::filesystem::remove(candidate);
  if (arguments.compare) from_nothing = seconds_from_nothing(arguments, settings, tools, log);
  return {{"kind", "elrom-retrain"},
          {"format", {1, 0}},
          {"program", program_version()},
          {"cases_before", earlier.size()},
          {"cases_after", study.cases().n_cases()},
          {"seconds", seconds},
          {"seconds_from_nothing", from_nothing ? Json(*from_nothing) : Json()},
          {"error_before", before},
          {"error_after", after},
          {"judged_on", study.held_out().empty() ? "cross-validation" : "held-out cases"},
          {"promoted", promoted}};
}

int print(const RetrainArguments& arguments, const Json& report) {
  if (!arguments.json.empty()) base::write_text(arguments.json, report.dump(1) + "\n");
  fmt::print("{} -> {} cases in {}; error {} -> {} ({}); {}\n", report["cases_before"].get<int>(),
             report["cases_after"].get<int>(), base::duration(report["seconds"]),
             base::rounded(report["error_before"]), base::rounded(report["error_after"]),
             report["judged_on"].get<std::string>(),
             report["promoted"].get<bool>() ? "promoted" : "not promoted: it would be worse");
  return 0;
}

int run_retrain(const RetrainArguments& arguments) {
  auto with = arguments.study;
  if (arguments.small) {
    with.effort = "quick";
    with.settings.emplace_back("peers.networks=false");
  }
  return in_study(with, [&](const study::Settings& settings, const study::Toolbox& tools, Log& log) {
    return print(arguments, retrain(arguments, settings, tools, log));
  });
}

}  // namespace

void add_retrain(CLI::App& app, Run& run) {
  auto* command =
      app.add_subcommand("retrain",
                         "take new cases of the store into an existing study; replaces model.elrom "
                         "only when the new model is not worse");
  auto arguments = std::make_shared<RetrainArguments>();
  arguments->study.add_to(*command);
  command->add_option("--json", arguments->json, "write the figures to this file");
  command->add_flag("--compare", arguments->compare,
                    "also build from nothing, to time it [recorded time of the last full run]");
  command->add_flag("--small", arguments->small,
                    "quick effort without networks: ends within a minute on small stores");
  command->callback([&run, arguments] { run = [arguments] { return run_retrain(*arguments); }; });
}

}  // namespace elrom::programs
