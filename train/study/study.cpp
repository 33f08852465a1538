#include "elrom/study/study.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "earlier_model.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/networks/split.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/versions.hpp"
#include "field_stage.hpp"
#include "method_set.hpp"
#include "study_bundle.hpp"
#include "timing.hpp"

namespace elrom::study {
namespace {

constexpr double least_equal = 0.9;  // share of columns that keep their band for earlier bands to hold

std::filesystem::path made(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw SystemError(
        {.what = "cannot make the study's folder", .where = folder.string(), .found = error.message()});
  return folder;
}

std::filesystem::path store_path(const std::filesystem::path& folder, const Settings& settings) {
  const auto store = folder / settings.store;  // which an absolute path replaces
  if (!std::filesystem::exists(store))
    throw InputError({.what = "no snapshot store",
                      .where = store.string(),
                      .advice = "name it with --store (the study remembers where it was), or make one with "
                                "elrom-data import"});
  return store;
}

/// For resolved.toml: a store beside or below the study moves with it.
std::string remembered(const std::filesystem::path& folder, const std::string& store) {
  const auto near = std::filesystem::path(store).lexically_normal().lexically_proximate(
      std::filesystem::weakly_canonical(folder));
  const bool is_far = near.is_absolute() || near.string().starts_with("../..");
  return is_far || !std::filesystem::path(store).is_absolute() ? store : near.string();
}

/// Empty for a bundle that cannot be read to its end.
std::string digest_if_whole(const std::filesystem::path& bundle) {
  try {
    const model::BundleReader reader(bundle);
    reader.file().verify_all();
    return reader.digest();
  } catch (const Error&) {
    return {};
  }
}

/// As a bundle tells them: without what says how and where it runs, or when a model is taken.
std::string settings_text(Settings settings) {
  const Settings defaults;
  settings.threads = defaults.threads;
  settings.device = defaults.device;
  settings.store = defaults.store;
  settings.date = defaults.date;
  settings.gate = defaults.gate;
  return to_toml(settings);
}

}  // namespace

struct Study::Impl {
  Impl(std::filesystem::path folder_, Settings settings_, Toolbox toolbox, Log& log_, std::stop_token stop_)
      : folder(made(std::move(folder_))),
        settings(std::move(settings_)),
        log(log_),
        stop(std::move(stop_)),
        lock(folder / ".lock"),
        store(field::SnapshotStore::open(store_path(folder, settings))),
        rows(held_out_rows()),
        cases(study_cases(store, settings, rows.building, log)),
        fields(field::choose_fields(store.fields(), settings.fields, "fields.names")),
        cache(folder / "stages", log),
        trials(folder / "search.sqlite"),
        workers(toolbox.workers),
        methods(settings, std::move(toolbox), &cache, &trials) {
    plain_cases = cases;
    plain_cases.mirrors.clear();  // peers as a user would run them: without mirror images
    auto resolved = settings;
    resolved.store = remembered(folder, settings.store);
    base::write_text(folder / "resolved.toml", to_toml(resolved));
    write_names();
    Versions versions(folder);
    if (versions.has_lost_its_log()) log.warning(versions.lost_log_sentence());
    versions.settle();
  }

  HeldOut held_out_rows() {
    settings.split.held_out = held_out_patterns(store, settings, log);
    expect_matches(store, settings.train.exclude, "train.exclude");
    return hold_out(store, *settings.split.held_out, settings.train.exclude);
  }

  [[nodiscard]] base::Seed seed() const { return base::Seed(static_cast<std::uint64_t>(settings.seed)); }
  [[nodiscard]] methods::FitContext context() const {
    return {.seed = seed(), .n_threads = settings.n_threads(), .log = &log, .stop = stop, .workers = workers};
  }

  void write_names() const {
    SplitNames split{
        .by = settings.split.by, .train = {}, .validation = {}, .test = {}, .held_out = {}, .excluded = {}};
    const auto parts = networks::split_cases(cases.loads, settings.split.fractions, seed());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      auto& names = parts[i] == networks::Part::train        ? split.train
                    : parts[i] == networks::Part::validation ? split.validation
                                                             : split.test;
      names.push_back(cases.names[i]);
    }
    for (const auto row : rows.held_out) split.held_out.push_back(store.cases()[row].inputs.name);
    for (const auto row : rows.excluded) split.excluded.push_back(store.cases()[row].inputs.name);
    write_split(folder / "split.json", split);
  }

  /// One field at a time is in memory.
  template <class Work>
  void for_every_field(const Work& work) {
    for (const auto& info : fields) {
      if (stop.stop_requested()) throw Interrupted("stopped on request; the next run goes on from here");
      field::FieldData data{&cases, info, store.read(info.name, rows.building)};
      work(data);
    }
  }

  std::vector<FieldOutcome> plan_networks(bool with_search) {
    const auto& networks = methods.networks();
    std::vector<FieldOutcome> outcomes;
    for_every_field([&](const field::FieldData& data) {
      const auto all = math::all_rows(cases.n_cases());
      auto bands = with_search
                       ? networks.plan(data, all, context()).bands
                       : networks::make_bands(networks.screen_field(data, all, context()), settings.bands);
      outcomes.push_back({.field = data.info.name,
                          .method = "networks",
                          .cross_validated_nrmse = NAN,
                          .bands = std::move(bands),
                          .columns_each = networks.columns_each(data)});
    });
    return outcomes;
  }

  /// What is known of the earlier cases' networks is in the cache; the fast screen tells whether it holds.
  std::vector<std::size_t> known_rows(const field::FieldData& data) {
    auto known = earlier->known_rows(data.info.name, {.cases = cases.names,
                                                      .case_digests = lineage().case_digests,
                                                      .settings_digest = settings_digest(settings.method)});
    if (known.empty()) return known;
    const auto all = math::all_rows(cases.n_cases());
    const auto& networks = methods.networks();
    const double equal =
        networks::equal_bands(networks.fast_screen(data, known, context()),
                              networks.fast_screen(data, all, context()), settings.bands.edges);
    log.info(fmt::format("{}: {:.0f} % of columns keep their band; networks {}", data.info.name, 100 * equal,
                         equal < least_equal ? "begin from nothing" : "go on from the earlier ones"));
    if (equal < least_equal) known.clear();
    return known;
  }

  std::vector<LeftOut> left_out_of(const std::string& name, const field::FieldData& data) {
    if (!earlier || name != "auto") return {};
    auto out = earlier->left_out(data.info.name, methods.candidates_of(name), cases.n_cases());
    std::string names;
    for (const auto& one : out) names += (names.empty() ? "" : ", ") + one.name;
    if (!out.empty())
      log.detail(
          fmt::format("{}: no part of the present model, so not fitted again before {} times its cases: {}",
                      data.info.name, EarlierModel::growth, names));
    return out;
  }

  // Peers see no mirrors; whatever else is asked for sees all that the study has.
  FieldStage fit_one(const std::string& name, field::FieldData& data, bool cross_validate) {
    const auto left_out = left_out_of(name, data);
    const bool networks_out = std::ranges::find(left_out, "networks", &LeftOut::name) != left_out.end();
    auto warm = earlier ? earlier->warm_start(data.info.name) : methods::WarmStart();
    if (earlier && methods.trains_networks(name) && !networks_out) warm.known = known_rows(data);
    data.cases = methods.is_peer(name) && name != settings.method ? &plain_cases : &cases;
    const FieldStageRequest request{
        .name = name,
        .candidates = methods.candidates_of(name),
        .data = data,
        .band_edges = settings.bands.edges,
        .n_folds = cross_validate ? static_cast<std::size_t>(settings.peers.folds) : 0,
        .warm = warm,
        .left_out = left_out};
    auto stage = fit_field(request, cache, context());
    data.cases = &cases;
    return stage;
  }

  std::vector<FieldOutcome> fit(bool with_peers, const std::filesystem::path& model_path) {
    const base::Stopwatch watch;
    const auto names = with_peers ? methods.bundles() : std::vector{settings.method};
    std::map<std::string, std::map<std::string, FieldStage>> stages;  // by method, field
    std::vector<FieldOutcome> outcomes;
    for_every_field([&](field::FieldData& data) {
      const auto& field = data.info.name;
      for (const auto& name : names) {
        if (stop.stop_requested()) throw Interrupted("stopped on request; the next run goes on from here");
        stages[name].emplace(field, fit_one(name, data, name == settings.method));
      }
      const auto& main = stages.at(settings.method).at(field);
      outcomes.push_back(outcome_of(field, main));
      log.info(fmt::format("{}: {}, cross-validated NRMSE {}", field, outcomes.back().method,
                           base::rounded(main.nrmse(), 3)));
    });
    if (model_path.empty())
      promote(stages.at(settings.method), with_peers ? "run" : earlier ? "retrain" : "fit");
    else
      write_study_bundle(model_path, bundle_of(settings.method), lineage(), stages.at(settings.method));
    for (const auto& [name, of_method] : stages)
      if (name != settings.method && promotion.kind != Promotion::Kind::refused) write_peer(name, of_method);
    FitCosts costs;
    for (const auto& [name, of_method] : stages) {
      for (const auto& [field, stage] : of_method) {
        costs.methods[name] += stage.seconds();
        for (const auto& [part, cost] : stage.costs()) costs.processor[name] += cost.processor_seconds;
        if (name == settings.method) add_costs(costs.candidates, stage.costs());
      }
    }
    write_timing(folder / "timing.json", cache.clock().entries(), watch.seconds(), settings.n_threads(),
                 costs);
    return outcomes;
  }

  static void add_costs(std::map<std::string, MethodCost>& to,
                        const std::map<std::string, MethodCost>& costs) {
    for (const auto& [name, cost] : costs) {
      to[name].seconds += cost.seconds;
      to[name].processor_seconds += cost.processor_seconds;
    }
  }

  static FieldOutcome outcome_of(const std::string& field, const FieldStage& stage) {
    const auto accuracy = nlohmann::json::parse(stage.accuracy());
    std::string best;
    for (const auto& candidate : accuracy["candidates"]) {
      if (candidate["weight"].get<double>() <= 0) continue;
      best += (best.empty() ? "" : " + ") + candidate["name"].get<std::string>();
    }
    return {.field = field, .method = best, .cross_validated_nrmse = stage.nrmse(), .bands = {}};
  }

  std::string settings_digest(const std::string& name) {
    std::vector<std::string> keys;
    for (const auto* method : methods.candidates_of(name))
      for (const auto& info : fields) keys.push_back(method->key(info.name));
    return base::digest_of_members(name, keys);
  }

  StudyBundle bundle_of(const std::string& name) {
    return {.method = name,
            .fields = fields,
            .cases = plain_cases,
            .furnace = store.furnace(),
            .store_digest = store.digest(rows.building),
            .settings_digest = settings_digest(name)};
  }

  Lineage lineage() {
    if (!usual_audit) usual_audit = usual_audit_of(store, rows.building);
    Lineage lineage{.case_digests = {},
                    .settings = settings_text(settings),
                    .date = settings.date,
                    .parent = {},
                    .usual_audit = *usual_audit};
    for (const auto row : rows.building) lineage.case_digests.push_back(store.digest({&row, 1}));
    return lineage;
  }

  void write_peer(const std::string& name, const FieldStages& stages) {
    const base::Stopwatch watch;
    write_study_bundle(made(folder / "peers") / (name + ".elrom"), bundle_of(name), lineage(), stages);
    cache.clock().add("bundle", watch.seconds(), false);
  }

  /// A version of this content that a run before this one left, or a new one.
  int version_of(const Versions& versions, const FieldStages& stages) {
    const base::Stopwatch watch;
    const auto bundle = bundle_of(settings.method);
    const auto content = content_of(bundle, stages);
    for (const int number : versions.numbers())
      if (holds_content(versions.file(number), content)) return number;
    const int number = versions.next();
    auto from = lineage();
    if (const auto current = versions.current()) from.parent = digest_if_whole(versions.file(*current));
    made(folder / "models");
    write_study_bundle(versions.file(number), bundle, from, stages);
    cache.clock().add("bundle", watch.seconds(), false);
    return number;
  }

  /// The model becomes a version, and where the gate lets it pass, or there is none yet, the present one.
  void promote(const FieldStages& stages, const std::string& by) {
    Versions versions(folder);
    judge_version(versions, version_of(versions, stages), by);
  }

  void judge_version(Versions& versions, int number, const std::string& by) {
    const auto current = versions.current();
    promotion = {.kind = Promotion::Kind::first, .number = number};
    if (current == promotion.number) {
      promotion.kind = Promotion::Kind::unchanged;
      return;
    }
    if (current && digest_if_whole(versions.file(*current)).empty()) {
      log.warning("the present model cannot be read: the new one takes its place without being compared");
    } else if (current) {
      promotion.verdict = judge(versions.file(*current), versions.file(promotion.number),
                                {store, rows.building, rows.held_out}, settings.gate, settings.n_threads());
      if (!promotion.verdict)
        log.warning(
            "the present model is of another mesh, other boundary conditions or other fields: nothing to compare; "
            "is the store that of this study?");
      const bool passed = promotion.verdict && promotion.verdict->passed;
      promotion.kind = passed ? Promotion::Kind::promoted : Promotion::Kind::refused;
    }
    const VersionEvent event{.number = promotion.number,
                             .by = by,
                             .promoted = promotion.kind != Promotion::Kind::refused,
                             .date = settings.date,
                             .verdict = promotion.verdict ? to_json(*promotion.verdict) : ""};
    if (!versions.is_known(event)) versions.record(event);
  }

  std::filesystem::path folder;
  Settings settings;
  Log& log;
  std::stop_token stop;
  base::FileLock lock;
  field::SnapshotStore store;
  HeldOut rows;
  Promotion promotion;
  std::optional<EarlierModel> earlier;                         // retraining only
  std::optional<std::vector<model::UsualFigure>> usual_audit;  // of the building cases, when first asked for
  field::CaseSet cases, plain_cases;
  std::vector<field::FieldInfo> fields;
  io::StageCache cache;
  networks::TrialStore trials;
  const networks::Workers* workers;
  MethodSet methods;
};

Study::Study(std::filesystem::path folder, Settings settings, Toolbox toolbox, Log& log, std::stop_token stop)
    : impl_(std::make_unique<Impl>(std::move(folder), std::move(settings), std::move(toolbox), log,
                                   std::move(stop))) {}
Study::~Study() = default;

std::vector<FieldOutcome> Study::screen() { return impl_->plan_networks(false); }
std::vector<FieldOutcome> Study::search() { return impl_->plan_networks(true); }
std::vector<FieldOutcome> Study::fit(const std::filesystem::path& bundle) {
  return impl_->fit(false, bundle);
}
std::vector<FieldOutcome> Study::run() { return impl_->fit(true, {}); }
const Promotion& Study::promotion() const { return impl_->promotion; }
const Settings& Study::settings() const { return impl_->settings; }
const field::SnapshotStore& Study::store() const { return impl_->store; }
const field::CaseSet& Study::cases() const { return impl_->cases; }
const std::vector<std::size_t>& Study::held_out() const { return impl_->rows.held_out; }
GateCases Study::gate_cases() const { return {impl_->store, impl_->rows.building, impl_->rows.held_out}; }

bool Study::is_of_this_study(const model::BundleInfo& bundle) const {
  const auto of = [&](const std::string& key) {
    const auto found = bundle.provenance.find(key);
    return found == bundle.provenance.end() ? std::string() : found->second;
  };
  const bool same_settings = bundle.settings.empty() || bundle.settings == settings_text(impl_->settings);
  return same_settings && bundle.method == impl_->settings.method &&
         of("store") == impl_->store.digest(impl_->rows.building);
}

std::optional<int> Study::version_of_these() const {
  const Versions versions(impl_->folder);
  for (const int number : versions.numbers()) {
    if (number == versions.current() || digest_if_whole(versions.file(number)).empty()) continue;
    if (is_of_this_study(model::BundleReader(versions.file(number)).info())) return number;
  }
  return std::nullopt;
}

void Study::judge_again(int version) {
  Versions versions(impl_->folder);
  impl_->judge_version(versions, version, "retrain");
}

void Study::begin_at(const std::filesystem::path& bundle) { impl_->earlier.emplace(bundle); }

}  // namespace elrom::study
