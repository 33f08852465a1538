#include "elrom/networks/stages.hpp"

#include "elrom/base/enum_names.hpp"
#include "elrom/networks/search.hpp"
#include "elrom/networks/stage_files.hpp"

namespace elrom::networks {
namespace {

Relevance relevance_named(const std::string& name) {
  constexpr base::EnumNames<Relevance, 3> names{
      "relevance", {{Relevance::none, "none"}, {Relevance::linear, "linear"}, {Relevance::gp, "gp"}}};
  return names.value(name);
}

RecordOptions record_options(const Settings& settings, const std::string& field) {
  const auto transform = settings.networks.transform.find(field);
  return {.encoding = model::plane_encoding_of(settings.networks.plane_encoding),
          .transform = model::transform_of(
              transform == settings.networks.transform.end() ? "none" : transform->second),
          .scale_cells = settings.networks.targets == "cell",
          .relevance = relevance_named(settings.networks.relevance)};
}

RecordOptions screened_options(RecordOptions options) {
  options.encoding = model::PlaneEncodingKind::index;
  options.relevance = Relevance::none;
  return options;
}

ScreenSettings read_by_its_method(ScreenSettings settings) {
  if (settings.method == "fast") return {.method = settings.method, .features = settings.features};
  settings.features = ScreenSettings{}.features;
  return settings;
}

SearchSettings read_by_the_search(SearchSettings settings) {
  const SearchSettings defaults;
  if (!settings.regularise)
    settings.weight_decay = defaults.weight_decay, settings.dropout = defaults.dropout;
  if (settings.confirm < 2) settings.confirm = 0, settings.confirm_seeds = defaults.confirm_seeds;
  return settings;
}

}  // namespace

FieldSettings settings_of_field(const Settings& settings, const std::string& field) {
  const auto records = record_options(settings, field);
  return {.screened = screened_options(records),
          .screen = read_by_its_method(settings.screen),
          .parts = part_rule(settings.split),
          .bands = settings.bands,
          .records = records,
          .search = read_by_the_search(settings.search),
          .activation = model::activation_of(settings.networks.activation),
          .fit = settings.fit,
          .epoch_records = settings.networks.epoch_records,
          .anneal = settings.networks.schedule == "cosine",
          .average = settings.networks.average && !settings.networks.mirrors && settings.symmetry.enabled,
          .symmetric = settings.networks.mirrors && settings.symmetry.enabled};
}

io::TensorFile ScreenStage::compute(const StageContext& context) const {
  const auto& data = records->get().records;
  ScreeningContext screening{.seed = seed,
                             .n_threads = settings.method == "fast" ? context.n_threads : context.n_trainings,
                             .log = context.log,
                             .stop = context.stop,
                             .task = "screen " + field};
  if (context.workers != nullptr)
    screening.crew_trainer = context.workers->crew_trainer(data, settings, seed);
  return to_file(screen(data, settings, screening));
}

io::TensorFile SearchStage::compute(const StageContext& context) const {
  const auto problem = make_problem(records->get().records, band);
  const TrainingBudget budget{settings.max_epochs, settings.patience, epoch_records, anneal};
  const SearchContext search_context{.name = field + ", " + band.name,
                                     .digest = io::stage_key(*this),
                                     .seed = seed,
                                     .store = context.trials,
                                     .log = context.log,
                                     .stop = context.stop};
  const auto found = search(
      [&](const Hyperparameters& h, base::Seed own, TrainingMonitor* monitor) {
        return trainer->train(problem, h, budget, own, monitor, context.stop);
      },
      settings, SearchSpace(settings, activation), search_context);
  return to_file(found.near_best, found.validation_mse);
}

io::TensorFile BuildStage::compute(const StageContext& context) const {
  auto problem = make_problem(records->get().records, band, records->parts_of_build(number));
  problem.start = start;
  const auto trained =
      trainer->train(problem, hyperparameters, budget, seed, nullptr, context.stop, context.checkpoint);
  tell_divergence(trained, name, *context.log);
  return to_file(trained);
}

}  // namespace elrom::networks
