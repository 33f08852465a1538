#include "elrom/methods/networks_method.hpp"

#include <algorithm>
#include <atomic>
#include <iterator>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/networks/stage_files.hpp"
#include "symmetric_part.hpp"

namespace elrom::methods {
namespace {

constexpr int cross_builds = 3;  // builds a band in cross-validation: enough to feel what averaging gains

std::vector<std::size_t> rows_of(const Folds& folds) {
  std::vector<std::size_t> rows;
  for (const auto& fold : folds) rows.insert(rows.end(), fold.begin(), fold.end());
  std::ranges::sort(rows);
  return rows;
}

/// Where each of `some` stands in `all`; both ascending.
std::vector<std::size_t> places_among(std::span<const std::size_t> all, std::span<const std::size_t> some) {
  std::vector<std::size_t> places;
  for (const auto row : some)
    places.push_back(static_cast<std::size_t>(std::ranges::lower_bound(all, row) - all.begin()));
  return places;
}

/// Of two that ascend.
std::vector<std::size_t> common(std::span<const std::size_t> some, std::span<const std::size_t> others) {
  std::vector<std::size_t> rows;
  std::ranges::set_intersection(some, others, std::back_inserter(rows));
  return rows;
}

/// The known ones, with a warm start from some; else all.
std::vector<std::size_t> planned_among(std::span<const std::size_t> cases, const FitContext& context) {
  auto known = context.warm == nullptr ? std::vector<std::size_t>() : context.warm->known_among(cases);
  return known.empty() ? std::vector(cases.begin(), cases.end()) : known;
}

FitContext without_warm_start(FitContext context) {
  context.warm = nullptr;
  return context;
}

networks::StageContext stage_context(const FitContext& context) {
  return {.n_threads = context.n_threads,
          .n_trainings = context.n_trainings(),
          .log = context.log,
          .stop = context.stop,
          .workers = context.workers};
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
    : settings_(std::move(settings)),
      trainer_(std::move(trainer)),
      cache_(cache),
      trials_(trials),
      kernel_(make_kernel_method()),
      asymmetry_(make_kernel_method({.symmetric = false})) {
  if (cache_ == nullptr) cache_ = &no_cache_;
}

std::string NetworksMethod::key(const std::string& field) const {
  const auto kept = kept_.find(field);
  const auto plan = kept == kept_.end() ? NetworkPlan() : kept->second;
  return base::digest_of_members(name(), networks::settings_of_field(settings_, field), plan.bands,
                                 plan.hyperparameters, *trainer_, asymmetry_->key(field));
}

void NetworksMethod::keep_plan(const std::string& field, NetworkPlan plan) { kept_[field] = std::move(plan); }

networks::RecordSource NetworksMethod::screened_records(const field::FieldData& data,
                                                        std::span<const std::size_t> cases,
                                                        const FitContext& context) const {
  const auto own = settings_of(data);
  return {data, cases, {.options = own.screened, .parts = own.parts, .seed = context.seed}};
}

class NetworksMethod::Learned {
 public:
  /// @param cases that the scale is learned from
  Learned(const field::FieldData& data, bool symmetric, std::span<const std::size_t> cases,
          const FitContext& context)
      : whole_(data) {
    if (symmetric) part_ = std::make_unique<SymmetricPart>(data, cases, context);
  }
  [[nodiscard]] const field::FieldData& data() const { return part_ ? part_->data() : whole_; }
  /// @param own of data()
  [[nodiscard]] std::unique_ptr<model::FieldModel> model(
      std::unique_ptr<model::FieldModel> own, std::unique_ptr<model::FieldModel> asymmetry = nullptr) const {
    return part_ ? part_->model(std::move(own), std::move(asymmetry)) : std::move(own);
  }

 private:
  const field::FieldData& whole_;
  std::unique_ptr<SymmetricPart> part_;
};

struct NetworksMethod::Records {
  Records(const field::FieldData& data, std::span<const std::size_t> cases,
          const networks::FieldSettings& settings, const FitContext& context)
      : known_cases(context.warm == nullptr ? std::vector<std::size_t>() : context.warm->known_among(cases)),
        known(data, known_cases, {settings.records, settings.parts, context.seed}),
        all(data, cases, {settings.records, settings.parts, context.seed, places_among(cases, known_cases)}) {
  }

  [[nodiscard]] bool go_on() const { return !known_cases.empty(); }
  [[nodiscard]] const networks::RecordSource& planned() const { return go_on() ? known : all; }

  std::vector<std::size_t> known_cases;
  networks::RecordSource known, all;
};

networks::ScreeningResult NetworksMethod::fast_screen(const field::FieldData& data,
                                                      std::span<const std::size_t> cases,
                                                      const FitContext& context) const {
  const Learned learned(data, settings_of(data).symmetric, cases, context);
  const auto source = screened_records(learned.data(), cases, context);
  return networks::screen_fast(source.get().records, settings_.screen,
                               {.seed = context.seed.derive("screen").derive(data.info.name),
                                .n_threads = context.n_threads,
                                .log = context.log,
                                .stop = context.stop,
                                .task = "fast screen " + data.info.name});
}

bool NetworksMethod::has_asymmetry(const field::FieldData& data) const {
  return settings_of(data).symmetric && !data.cases->mirrors.empty();
}

std::size_t NetworksMethod::columns_each(const field::FieldData& data) const {
  if (!settings_of(data).symmetric) return 1;
  const auto& cases = *data.cases;
  return cases.mesh.n_columns /
         FundamentalDomain(cases, data.info.parity, symmetry_classes(cases.mirrors.size())).n_columns();
}

networks::ScreeningResult NetworksMethod::screen_field(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const {
  const Learned learned(data, settings_of(data).symmetric, cases, context);
  return screen_learned(learned.data(), cases, context);
}

networks::ScreeningResult NetworksMethod::screen_learned(const field::FieldData& data,
                                                         std::span<const std::size_t> cases,
                                                         const FitContext& context) const {
  const auto& field = data.info.name;
  const auto source = screened_records(data, cases, context);
  const networks::ScreenStage stage{.field = field,
                                    .records = &source,
                                    .settings = settings_of(data).screen,
                                    .seed = context.seed.derive("screen").derive(field)};
  return networks::screening_of(cache_->get(field, stage, stage_context(context)));
}

NetworkPlan NetworksMethod::plan(const field::FieldData& data, std::span<const std::size_t> cases,
                                 const FitContext& context) const {
  const auto own = settings_of(data);
  const auto planned = planned_among(cases, context);
  const Learned learned(data, own.symmetric, planned, without_warm_start(context));
  const Records records(learned.data(), cases, own, context);
  return plan_learned(learned.data(), planned, records.planned(), context);
}

NetworkPlan NetworksMethod::plan_learned(const field::FieldData& data, std::span<const std::size_t> cases,
                                         const networks::RecordSource& records,
                                         const FitContext& context) const {
  const auto& field = data.info.name;
  if (const auto kept = kept_.find(field); kept != kept_.end()) return kept->second;
  const auto own = settings_of(data);
  NetworkPlan plan;
  plan.screening = screen_learned(data, cases, context);
  plan.bands = networks::make_bands(plan.screening, own.bands);
  plan.hyperparameters.resize(plan.bands.size());
  auto running = stage_context(context);
  running.trials = trials_;
  base::parallel_for(
      plan.bands.size(), context.n_trainings(),
      [&](std::size_t i, int) {
        const auto& band = plan.bands[i];
        const networks::SearchStage stage{
            .field = field,
            .records = &records,
            .band = band,
            .settings = own.search,
            .epoch_records = own.epoch_records,
            .anneal = own.anneal,
            .activation = own.activation,
            .trainer = trainer_.get(),
            .seed = context.seed.derive("search").derive(field).derive(band.name)};
        plan.hyperparameters[i] =
            networks::hyperparameters_of(cache_->get(field + "-" + band.name, stage, running));
      },
      context.stop);
  return plan;
}

networks::TrainingResult NetworksMethod::train(const networks::BuildStage& stage,
                                               const FitContext& context) const {
  auto running = stage_context(context);
  running.checkpoint = cache_->path("checkpoint", stage.name, stage, ".part");
  const auto file = cache_->get(stage.name, stage, running);
  if (!running.checkpoint.empty()) std::filesystem::remove(running.checkpoint);
  return networks::training_of(file);
}

std::vector<model::Submodel> NetworksMethod::build(const field::FieldData& data, const NetworkPlan& plan,
                                                   const Records& records, int n_builds,
                                                   const FitContext& context, int n_threads) const {
  const auto& field = data.info.name;
  const auto own = settings_of(data);
  const auto n = static_cast<std::size_t>(n_builds);
  std::vector<std::vector<networks::TrainingResult>> results(plan.bands.size(),
                                                             std::vector<networks::TrainingResult>(n));
  base::parallel_for(
      plan.bands.size() * n, n_threads,
      [&](std::size_t unit, int) {
        const std::size_t i_band = unit / n, i_build = unit % n;
        const auto& band = plan.bands[i_band];
        // The best build is one of errors on the same cases.
        const std::size_t i_fold = own.fit.combine == "best" ? 0 : i_build;
        networks::BuildStage stage{
            .name = field + "-" + band.name + "-" + std::to_string(i_build),
            .records = &records.planned(),
            .number = {i_fold, static_cast<std::size_t>(own.fit.builds)},
            .band = band,
            .hyperparameters = plan.hyperparameters[i_band][i_build % plan.hyperparameters[i_band].size()],
            .budget = {own.fit.max_epochs, own.fit.patience, own.epoch_records, own.anneal},
            .trainer = trainer_.get(),
            .seed = context.seed.derive("fit").derive(field).derive(band.name).derive(i_build)};
        auto result = train(stage, context);
        if (records.go_on()) {
          stage.records = &records.all;
          stage.start = networks::parameters_of(result.network);
          result = train(stage, context);
        }
        results[i_band][i_build] = std::move(result);
      },
      context.stop);
  std::vector<model::Submodel> submodels;
  for (std::size_t i = 0; i < plan.bands.size(); ++i) {
    submodels.push_back(assemble_submodel(plan.bands[i], std::move(results[i]), field));
  }
  return submodels;
}

std::unique_ptr<model::FieldModel> NetworksMethod::assemble(const field::FieldData& data,
                                                            const networks::RecordSet& set,
                                                            std::vector<model::Submodel> submodels) const {
  const auto own = settings_of(data);
  model::BandedNetworks::Parts parts{
      .n_columns = data.cases->mesh.n_columns,
      .inputs = set.inputs,
      .planes = set.planes,
      .transform = set.transform,
      .outputs = set.outputs,
      .submodels = std::move(submodels),
      .combination = own.fit.combine == "best" ? model::Combination::best : model::Combination::mean};
  auto networks = std::make_unique<model::BandedNetworks>(std::move(parts));
  const auto& shared = *data.cases;
  if (!own.average || shared.mirrors.empty()) return networks;
  const auto group = field::symmetry_group(shared.mirrors, shared.schema.size(), shared.mesh.n_cells());
  return std::make_unique<model::MirrorModel>(std::move(networks), group, data.info.parity,
                                              shared.mesh.n_planes);
}

std::unique_ptr<model::FieldModel> NetworksMethod::fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const {
  const auto own = settings_of(data);
  const auto planned = planned_among(cases, context);
  const Learned learned(data, own.symmetric, planned, without_warm_start(context));
  const Records records(learned.data(), cases, own, context);
  const auto found = plan_learned(learned.data(), planned, records.planned(), context);
  auto submodels = build(learned.data(), found, records, own.fit.builds, context, context.n_trainings());
  auto model = assemble(learned.data(), records.all.get(), std::move(submodels));
  return learned.model(std::move(model),
                       has_asymmetry(data) ? asymmetry_->fit(data, cases, context) : nullptr);
}

MatrixF NetworksMethod::asymmetry_in_folds(const field::FieldData& data, const Folds& folds,
                                           std::span<const std::size_t> wanted,
                                           const FitContext& context) const {
  if (context.known == nullptr || context.known->key != kernel_->key(data.info.name))
    return asymmetry_->predict_folds(data, folds, wanted, context);
  const MatrixF& whole = context.known->values;
  std::vector<std::size_t> rows;
  for (const auto i_fold : wanted) rows.insert(rows.end(), folds[i_fold].begin(), folds[i_fold].end());
  const FundamentalDomain domain(*data.cases, data.info.parity, symmetry_classes(data.cases->mirrors.size()));
  MatrixF symmetric = MatrixF::Zero(static_cast<Eigen::Index>(rows.size()), whole.cols());
  domain.add(0, domain.project(whole, rows, 0, context.n_threads), symmetric, context.n_threads);
  MatrixF asymmetry = MatrixF::Zero(whole.rows(), whole.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(rows[i]);
    asymmetry.row(row) = whole.row(row) - symmetric.row(static_cast<Eigen::Index>(i));
  }
  return asymmetry;
}

MatrixF NetworksMethod::predict_folds(const field::FieldData& data, const Folds& folds,
                                      std::span<const std::size_t> wanted, const FitContext& context) const {
  const auto rows = rows_of(folds);
  const auto known = planned_among(rows, context);
  const auto cold = without_warm_start(context);
  const auto found = plan(data, known, cold);
  const auto own = settings_of(data);
  MatrixF predicted = has_asymmetry(data) ? asymmetry_in_folds(data, folds, wanted, context)
                                          : MatrixF::Zero(data.values.rows(), data.values.cols());
  std::atomic<std::int64_t> done{0};
  const auto total = static_cast<std::int64_t>(wanted.size());
  const int n_builds = std::min(own.fit.builds, cross_builds);
  const int within_fold = std::max(1, context.n_trainings() / static_cast<int>(wanted.size()));
  base::parallel_for(
      wanted.size(), context.n_trainings(),
      [&](std::size_t i, int) {
        const std::size_t i_fold = wanted[i];
        const auto others = common(known, rows_without(folds, i_fold));
        auto within = cold;
        within.n_threads = std::max(1, context.n_threads / static_cast<int>(wanted.size()));
        const Learned learned(data, own.symmetric, others, within);
        const Records records(learned.data(), others, own, cold);
        auto submodels = build(learned.data(), found, records, n_builds, cold, within_fold);
        const auto model = learned.model(assemble(learned.data(), records.all.get(), std::move(submodels)));
        model::Workspace workspace;
        std::vector<float> values(static_cast<std::size_t>(predicted.cols()));
        for (const auto row : folds[i_fold]) {
          const auto place = static_cast<Eigen::Index>(row);
          const std::span inputs(data.cases->inputs.row(place).data(), data.cases->schema.size());
          predict_case(*model, inputs, data.cases->mesh.n_planes, values, workspace);
          predicted.row(place) += Eigen::RowVectorXf::Map(values.data(), predicted.cols());
        }
        context.log->progress({"cross-validate networks, " + data.info.name, ++done, total, "folds"});
      },
      context.stop);
  return predicted;
}

}  // namespace elrom::methods
