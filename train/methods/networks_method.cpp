#include "elrom/methods/networks_method.hpp"

#include <atomic>
#include <mutex>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/networks/records.hpp"
#include "elrom/networks/search.hpp"
#include "elrom/networks/split.hpp"
#include "elrom/networks/stage_files.hpp"

namespace elrom::methods {
namespace {

constexpr int cross_builds = 2;  // builds a band in cross-validation: enough to feel what averaging gains

std::string digest_of(const std::vector<std::string>& parts) {
  base::Sha256 digest;
  for (const auto& part : parts) digest.add(part);
  return digest.hex();
}

std::vector<std::size_t> rows_of(const Folds& folds) {
  std::vector<std::size_t> rows;
  for (const auto& fold : folds) rows.insert(rows.end(), fold.begin(), fold.end());
  std::ranges::sort(rows);
  return rows;
}

std::string digest_of(const NetworkPlan& plan) {
  base::Sha256 digest;
  for (std::size_t i = 0; i < plan.bands.size(); ++i) {
    digest.add(plan.bands[i].name).add(networks::SearchSpace::key(plan.hyperparameters[i]));
    digest.add(std::as_bytes(std::span(plan.bands[i].columns)))
        .add(std::as_bytes(std::span(plan.bands[i].mask)));
  }
  return digest.hex();
}

// A submodel needs one network that did not diverge.
model::Submodel assemble_submodel(const networks::Band& band, std::vector<networks::TrainingResult> results,
                                  const std::string& field) {
  model::Submodel submodel{
      .name = band.name, .columns = band.columns, .mask = band.mask, .builds = {}, .scores = {}};
  for (auto& result : results) {
    if (result.diverged) continue;
    submodel.builds.push_back(std::move(result.network));
    submodel.scores.push_back(result.validation_mse);
  }
  if (submodel.builds.empty()) {
    throw NumericalError(
        {.what = "every build of submodel '" + band.name + "' diverged",
         .where = field,
         .advice = "lower search.learning_rate, or look for wild cells with elrom-data check"});
  }
  return submodel;
}

}  // namespace

NetworksMethod::NetworksMethod(networks::Settings settings, std::shared_ptr<const networks::Trainer> trainer,
                               const io::StageCache* cache, networks::TrialStore* trials)
    : settings_(std::move(settings)), trainer_(std::move(trainer)), cache_(cache), trials_(trials) {
  if (cache_ == nullptr) cache_ = &no_cache_;
}

std::vector<networks::Part> NetworksMethod::split(const field::FieldData& data,
                                                  std::span<const std::size_t> cases,
                                                  const FitContext& context) const {
  std::vector<double> loads;
  for (const auto row : cases) loads.push_back(data.cases->loads[row]);
  return networks::split_records(loads, data.cases->mesh.n_planes, settings_.split, context.seed);
}

networks::RecordOptions NetworksMethod::record_options(const std::string& field) const {
  const auto transform = settings_.networks.transform.find(field);
  return {.encoding = model::plane_encoding_of(settings_.networks.plane_encoding),
          .transform = model::transform_of(
              transform == settings_.networks.transform.end() ? "none" : transform->second),
          .scale_cells = settings_.networks.targets == "cell",
          .mirrors = settings_.networks.mirrors && settings_.symmetry.enabled,
          .relevance = networks::relevance_kind_of(settings_.networks.relevance)};
}

void NetworksMethod::keep_plan(const std::string& field, NetworkPlan plan) { kept_[field] = std::move(plan); }

networks::RecordSet NetworksMethod::screening_records(const field::FieldData& data,
                                                      std::span<const std::size_t> cases,
                                                      const FitContext& context) const {
  auto options = record_options(data.info.name);
  options.encoding = model::PlaneEncodingKind::index;  // the source's input, whatever the submodels get
  options.mirrors = false;
  options.relevance = networks::Relevance::none;
  return networks::make_records(data, cases, split(data, cases, context), options);
}

networks::ScreeningResult NetworksMethod::fast_screen(const field::FieldData& data,
                                                      std::span<const std::size_t> cases,
                                                      const FitContext& context) const {
  const auto set = screening_records(data, cases, context);
  return networks::screen_fast(set.records, settings_.screen,
                               {.seed = context.seed.derive("screen").derive(data.info.name),
                                .n_threads = context.n_threads,
                                .log = context.log,
                                .stop = context.stop,
                                .task = "fast screen " + data.info.name});
}

networks::ScreeningResult NetworksMethod::screen_field(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const {
  const auto& field = data.info.name;
  const auto seed = context.seed.derive("screen").derive(field);
  const auto digest =
      digest_of({field::data_digest(data, cases),
                 base::digest_of_members(settings_.screen, settings_.split, settings_.networks),
                 std::to_string(context.seed.value())});
  const auto file = cache_->get("screen", field, digest, [&] {
    const auto set = screening_records(data, cases, context);
    networks::ScreeningContext screening{
        .seed = seed,
        .n_threads = settings_.screen.method == "fast" ? context.n_threads : context.n_trainings(),
        .log = context.log,
        .stop = context.stop,
        .task = "screen " + field};
    if (context.workers != nullptr)
      screening.crew_trainer = context.workers->crew_trainer(set.records, settings_.screen, seed);
    return to_file(screen(set.records, settings_.screen, screening));
  });
  return networks::screening_of(file);
}

NetworkPlan NetworksMethod::plan(const field::FieldData& data, std::span<const std::size_t> cases,
                                 const FitContext& context) const {
  const auto& field = data.info.name;
  if (const auto kept = kept_.find(field); kept != kept_.end()) return kept->second;
  NetworkPlan plan;
  plan.screening = screen_field(data, cases, context);
  plan.bands = networks::make_bands(plan.screening, settings_.bands);
  plan.hyperparameters.resize(plan.bands.size());
  const auto digest =
      digest_of({field::data_digest(data, cases),
                 base::digest_of_members(settings_.screen, settings_.split, settings_.bands, settings_.search,
                                         settings_.networks, settings_.symmetry),
                 std::to_string(context.seed.value()), trainer_->name()});
  const networks::SearchSpace space(settings_.search, model::activation_of(settings_.networks.activation));
  std::once_flag once;
  networks::RecordSet set;  // made only when a search is not in the cache
  const auto records = [&]() -> const networks::ScreeningData& {
    std::call_once(once, [&] {
      set = networks::make_records(data, cases, split(data, cases, context), record_options(field));
    });
    return set.records;
  };
  base::parallel_for(
      plan.bands.size(), context.n_trainings(),
      [&](std::size_t i, int) {
        const auto& band = plan.bands[i];
        const auto file = cache_->get("search", field + "-" + band.name, digest, [&] {
          const auto problem = networks::make_problem(records(), band);
          const networks::TrainingBudget budget{settings_.search.max_epochs, settings_.search.patience};
          const networks::SearchContext search_context{
              .name = field + ", " + band.name,
              .digest = digest + " " + field + " " + band.name,
              .seed = context.seed.derive("search").derive(field).derive(band.name),
              .store = trials_,
              .log = context.log,
              .stop = context.stop};
          const auto found = search(
              [&](const networks::Hyperparameters& h, base::Seed seed, networks::TrainingMonitor* monitor) {
                return trainer_->train(problem, h, budget, seed, monitor, context.stop);
              },
              settings_.search, space, search_context);
          return to_file(found.best, found.validation_mse);
        });
        plan.hyperparameters[i] = networks::hyperparameters_of(file);
      },
      context.stop);
  return plan;
}

std::vector<model::Submodel> NetworksMethod::build(const field::FieldData& data, const NetworkPlan& plan,
                                                   const networks::RecordSet& set, const std::string& digest,
                                                   int n_builds, const FitContext& context,
                                                   int n_threads) const {
  const auto& field = data.info.name;
  const auto n = static_cast<std::size_t>(n_builds);
  std::vector<networks::TrainingProblem> problems;
  for (const auto& band : plan.bands) problems.push_back(networks::make_problem(set.records, band));
  std::vector<std::vector<networks::TrainingResult>> results(plan.bands.size(),
                                                             std::vector<networks::TrainingResult>(n));
  const networks::TrainingBudget budget{settings_.fit.max_epochs, settings_.fit.patience};
  base::parallel_for(
      plan.bands.size() * n, n_threads,
      [&](std::size_t unit, int) {
        const std::size_t i_band = unit / n, i_build = unit % n;
        const auto name = field + "-" + plan.bands[i_band].name + "-" + std::to_string(i_build);
        const auto unit_digest =
            digest_of({digest, plan.bands[i_band].name,
                       networks::SearchSpace::key(plan.hyperparameters[i_band]), std::to_string(i_build)});
        const auto checkpoint = cache_->path("checkpoint", name, unit_digest, ".part");
        const auto file = cache_->get("build", name, unit_digest, [&] {
          const auto seed =
              context.seed.derive("fit").derive(field).derive(plan.bands[i_band].name).derive(i_build);
          const auto trained = trainer_->train(problems[i_band], plan.hyperparameters[i_band], budget, seed,
                                               nullptr, context.stop, checkpoint);
          networks::tell_divergence(trained, name, *context.log);
          return to_file(trained);
        });
        if (!checkpoint.empty()) std::filesystem::remove(checkpoint);
        results[i_band][i_build] = networks::training_of(file);
      },
      context.stop);
  std::vector<model::Submodel> submodels;
  for (std::size_t i = 0; i < plan.bands.size(); ++i) {
    submodels.push_back(assemble_submodel(plan.bands[i], std::move(results[i]), field));
  }
  return submodels;
}

std::unique_ptr<model::FieldModel> NetworksMethod::assemble(const field::FieldData& data,
                                                            networks::RecordSet set,
                                                            std::vector<model::Submodel> submodels) const {
  model::BandedNetworks::Parts parts{
      .n_columns = data.cases->mesh.n_columns,
      .inputs = std::move(set.inputs),
      .planes = set.planes,
      .transform = set.transform,
      .outputs = std::move(set.outputs),
      .submodels = std::move(submodels),
      .combination = settings_.fit.combine == "best" ? model::Combination::best : model::Combination::mean};
  auto networks = std::make_unique<model::BandedNetworks>(std::move(parts));
  const auto& shared = *data.cases;
  if (!settings_.networks.average || !settings_.symmetry.enabled || shared.mirrors.empty()) return networks;
  const auto group = field::symmetry_group(shared.mirrors, shared.schema.size(), shared.mesh.n_cells());
  return std::make_unique<model::MirrorModel>(std::move(networks), group, data.info.parity,
                                              shared.mesh.n_planes);
}

std::unique_ptr<model::FieldModel> NetworksMethod::fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const {
  const auto found = plan(data, cases, context);
  auto set = networks::make_records(data, cases, split(data, cases, context), record_options(data.info.name));
  const auto digest =
      digest_of({"fit", digest_of(found), field::data_digest(data, cases), base::digest_of_members(settings_),
                 std::to_string(context.seed.value()), trainer_->name()});
  auto submodels = build(data, found, set, digest, settings_.fit.builds, context, context.n_trainings());
  return assemble(data, std::move(set), std::move(submodels));
}

MatrixF NetworksMethod::cross_predict(const field::FieldData& data, const Folds& folds,
                                      const FitContext& context) const {
  const auto rows = rows_of(folds);
  const auto found = plan(data, rows, context);
  MatrixF predicted = MatrixF::Zero(data.values.rows(), data.values.cols());
  std::atomic<std::int64_t> done{0};
  const auto total = static_cast<std::int64_t>(folds.size());
  const int within_fold = std::max(1, context.n_trainings() / static_cast<int>(folds.size()));
  base::parallel_for(
      folds.size(), context.n_trainings(),
      [&](std::size_t i_fold, int) {
        const auto rest = rows_without(folds, i_fold);
        auto set =
            networks::make_records(data, rest, split(data, rest, context), record_options(data.info.name));
        const auto digest = digest_of({"fold", digest_of(found), field::data_digest(data, rest),
                                       base::digest_of_members(settings_),
                                       std::to_string(context.seed.value()), trainer_->name()});
        auto submodels = build(data, found, set, digest, std::min(settings_.fit.builds, cross_builds),
                               context, within_fold);
        const auto model = assemble(data, std::move(set), std::move(submodels));
        model::Workspace workspace;
        for (const auto row : folds[i_fold]) {
          const auto i = static_cast<Eigen::Index>(row);
          const std::span inputs(data.cases->inputs.row(i).data(), data.cases->schema.size());
          predict_case(*model, inputs, data.cases->mesh.n_planes,
                       {predicted.row(i).data(), static_cast<std::size_t>(predicted.cols())}, workspace);
        }
        context.log->progress({"cross-validate networks, " + data.info.name, ++done, total, "folds"});
      },
      context.stop);
  return predicted;
}

}  // namespace elrom::methods
