#include "settings_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/field/furnace.hpp"

namespace elrom::study {
namespace {

const std::vector<std::string> levels{"quick", "standard", "thorough"};

bool are_fractions(const std::vector<double>& v) {
  return v.size() == 3 && v[0] > 0 && v[1] > 0 && v[2] >= 0 && std::abs(v[0] + v[1] + v[2] - 1) < 1e-9;
}

bool are_edges(const std::vector<double>& v) {
  return std::ranges::is_sorted(v, std::less_equal<>{}) &&
         std::ranges::all_of(v, [](double x) { return x > 0; });
}

std::vector<std::string> with_auto(std::vector<std::string> names) {
  names.insert(names.begin(), "auto");
  return names;
}

io::SettingsTable<Settings> make_table() {
  io::SettingsTable<Settings> t;
  t.word(
      "effort", "what the run may cost: quick (minutes), standard (tens of minutes), thorough (hours)",
      [](auto& s) -> auto& { return s.effort; }, levels);
  t.word(
      "method", "auto picks per field by cross-validation; or one method for every field",
      [](auto& s) -> auto& { return s.method; }, with_auto(methods::method_names()));
  t.word(
      "store", "snapshot store, relative to the study's folder", [](auto& s) -> auto& { return s.store; });
  t.whole(
      "seed", "seed of every random stream", [](auto& s) -> auto& { return s.seed; },
      std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max());
  t.whole(
      "threads", "threads of every stage; 0: all", [](auto& s) -> auto& { return s.threads; }, 0, 4096);
  t.word("device", "where LibTorch trains", [](auto& s) -> auto& { return s.device; }, {"cpu", "cuda"});
  t.word(
      "date", "kept in the bundle as it stands, so that bytes repeat; empty: none",
      [](auto& s) -> auto& { return s.date; });
  t.words(
      "fields.names", "fields to build; empty: all of the store", [](auto& s) -> auto& { return s.fields; });
  t.words(
      "split.held_out", "cases never built with: names or patterns; not set: those of the store's furnace",
      [](auto& s) -> auto& { return s.split.held_out; });
  t.word("split.by", "case: planes of a case stay together; record: they do not (leaks)",
         [](auto& s) -> auto& { return s.split.by; }, {"case", "record"});
  t.numbers(
      "split.fractions", "train, validation, test", [](auto& s) -> auto& { return s.split.fractions; },
      are_fractions, "three fractions that add up to 1, train and validation above 0");
  t.words(
      "train.exclude", "cases neither trained on nor held out: names or patterns",
      [](auto& s) -> auto& { return s.train.exclude; });
  t.real(
      "gate.tolerance", "NRMSE that a field may lose when a new model takes the present one's place",
      [](auto& s) -> auto& { return s.gate.tolerance; }, 0, 1);
  t.real(
      "gate.deviations", "standard deviations of scatter from which on a difference is real",
      [](auto& s) -> auto& { return s.gate.deviations; }, 0, 100);
  t.flag(
      "symmetry.enabled", "use the declared mirror images",
      [](auto& s) -> auto& { return s.symmetry.enabled; });
  t.tables(
      "symmetry.mirror", "mirror images; none: those of the store's furnace",
      [](auto& s) -> auto& { return s.symmetry.mirrors; }, field::mirror_table());
  t.word("screen.method", "networks: build them for every column; fast: closed form",
         [](auto& s) -> auto& { return s.screen.method; }, {"networks", "fast"});
  t.whole(
      "screen.builds", "builds of every column", [](auto& s) -> auto& { return s.screen.builds; }, 1, 100);
  t.whole(
      "screen.n_units", "hidden units of the default network",
      [](auto& s) -> auto& { return s.screen.n_units; }, 1, 1024);
  t.whole(
      "screen.batch_size", "records a step", [](auto& s) -> auto& { return s.screen.batch_size; }, 1, 65536);
  t.whole(
      "screen.epoch_records", "records of an epoch at most, 0: all; the next epoch goes on with the others",
      [](auto& s) -> auto& { return s.screen.epoch_records; }, 0);
  t.real(
      "screen.learning_rate", "Adam's step", [](auto& s) -> auto& { return s.screen.learning_rate; }, 1e-7,
      1);
  t.whole(
      "screen.max_epochs", "longest build", [](auto& s) -> auto& { return s.screen.max_epochs; }, 1);
  t.whole(
      "screen.patience", "epochs without a better validation error",
      [](auto& s) -> auto& { return s.screen.patience; }, 1);
  t.whole(
      "screen.features", "random features of the fast screen",
      [](auto& s) -> auto& { return s.screen.features; }, 1, 8192);
  t.word("bands.scope", "field: a column has one band; plane: one in every plane",
         [](auto& s) -> auto& { return s.bands.scope; }, {"field", "plane"});
  t.numbers(
      "bands.edges", "error limits between bands", [](auto& s) -> auto& { return s.bands.edges; }, are_edges,
      "ascending numbers above 0");
  t.word("search.algorithm", "NLopt's search over the hyperparameters",
         [](auto& s) -> auto& { return s.search.algorithm; },
         {"direct", "sobol_bobyqa", "sbplx", "crs2", "random"});
  t.whole(
      "search.trials", "distinct trials a submodel", [](auto& s) -> auto& { return s.search.trials; }, 1);
  t.flag(
      "search.prune", "give up hopeless trials (ASHA)", [](auto& s) -> auto& { return s.search.prune; });
  t.whole(
      "search.confirm", "best trials that are built again", [](auto& s) -> auto& { return s.search.confirm; },
      0, 100);
  t.whole(
      "search.confirm_seeds", "builds of each of those",
      [](auto& s) -> auto& { return s.search.confirm_seeds; }, 1, 100);
  t.whole(
      "search.max_epochs", "longest trial", [](auto& s) -> auto& { return s.search.max_epochs; }, 1);
  t.whole(
      "search.patience", "epochs without a better validation error",
      [](auto& s) -> auto& { return s.search.patience; }, 1);
  t.range(
      "search.learning_rate", "range", [](auto& s) -> auto& { return s.search.learning_rate; }, 1e-7, 1);
  t.range(
      "search.n_layers", "range of hidden layers", [](auto& s) -> auto& { return s.search.n_layers; }, 1, 16);
  t.range(
      "search.n_units", "range of units a layer", [](auto& s) -> auto& { return s.search.n_units; }, 1, 4096);
  t.range(
      "search.batch_size", "range of records a step", [](auto& s) -> auto& { return s.search.batch_size; }, 1,
      65536);
  t.range(
      "search.weight_decay", "range, searched with search.regularise",
      [](auto& s) -> auto& { return s.search.weight_decay; }, 1e-12, 10);
  t.range(
      "search.dropout", "range, searched with search.regularise",
      [](auto& s) -> auto& { return s.search.dropout; }, 0, 0.9);
  t.flag(
      "search.regularise", "search weight decay and dropout too",
      [](auto& s) -> auto& { return s.search.regularise; });
  t.whole(
      "fit.builds", "builds of every submodel; they take nearly best hyperparameters in turn",
      [](auto& s) -> auto& { return s.fit.builds; }, 1, 100);
  t.word("fit.combine", "what a submodel answers with", [](auto& s) -> auto& { return s.fit.combine; },
         {"mean", "best"});
  t.whole(
      "fit.max_epochs", "longest build", [](auto& s) -> auto& { return s.fit.max_epochs; }, 1);
  t.whole(
      "fit.patience", "epochs without a better validation error",
      [](auto& s) -> auto& { return s.fit.patience; }, 1);
  t.word("networks.plane_encoding", "how a network is told the plane",
         [](auto& s) -> auto& { return s.networks.plane_encoding; }, {"index", "fourier", "one_hot"});
  t.word("networks.activation", "of the hidden layers",
         [](auto& s) -> auto& { return s.networks.activation; }, {"relu", "tanh", "silu"});
  t.word("networks.targets", "standardised by column (the source) or by cell",
         [](auto& s) -> auto& { return s.networks.targets; }, {"column", "cell"});
  t.whole(
      "networks.epoch_records", "records of an epoch at most, 0: all; the next epoch goes on with the others",
      [](auto& s) -> auto& { return s.networks.epoch_records; }, 0);
  t.word("networks.schedule", "the learning rate falls to nothing by half a cosine, or stays (the source)",
         [](auto& s) -> auto& { return s.networks.schedule; }, {"cosine", "constant"});
  t.flag(
      "networks.mirrors",
      "networks learn the symmetric part of a field over its scale, POD + MLP from mirror images too",
      [](auto& s) -> auto& { return s.networks.mirrors; });
  t.flag(
      "networks.average", "average what networks answer over mirror images, with networks.mirrors=false",
      [](auto& s) -> auto& { return s.networks.average; });
  t.word("networks.relevance",
         "scale the inputs by their weight in a ridge fit, or by a process's length scales",
         [](auto& s) -> auto& { return s.networks.relevance; }, {"none", "linear", "gp"});
  t.choices_by_name("networks.transform",
                    "transform of the targets by field: none, log or asinh, { field = \"log\" }",
                    [](auto& s) -> auto& { return s.networks.transform; }, {"none", "log", "asinh"});
  t.words(
      "peers.methods", "fitted beside the model, each to a bundle of its own",
      [](auto& s) -> auto& { return s.peers.methods; });
  t.flag(
      "peers.networks", "networks compete in auto and get a bundle of their own",
      [](auto& s) -> auto& { return s.peers.networks; });
  t.whole(
      "peers.folds",
      "folds by load of auto's cross-validation; intervals are scored on spread ones, twice as many below 128 "
      "cases",
      [](auto& s) -> auto& { return s.peers.folds; }, 2, 1000);
  return t;
}

// What each effort level changes.
struct EffortRow {
  std::function<int&(Settings&)> member;
  std::array<int, 3> value;
};

const std::vector<EffortRow>& effort_rows() {
  using S = Settings;
  static const std::vector<EffortRow> rows{
      {[](S& s) -> int& { return s.screen.max_epochs; }, {25, 60, 120}},
      {[](S& s) -> int& { return s.screen.patience; }, {3, 6, 10}},
      {[](S& s) -> int& { return s.search.trials; }, {4, 12, 50}},
      {[](S& s) -> int& { return s.search.confirm; }, {0, 2, 5}},
      {[](S& s) -> int& { return s.search.confirm_seeds; }, {1, 2, 3}},
      {[](S& s) -> int& { return s.search.max_epochs; }, {24, 24, 120}},
      {[](S& s) -> int& { return s.search.patience; }, {5, 5, 12}},
      {[](S& s) -> int& { return s.fit.max_epochs; }, {40, 60, 400}},
      {[](S& s) -> int& { return s.fit.patience; }, {6, 8, 30}},
      {[](S& s) -> int& { return s.peers.folds; }, {6, 6, 10}},
  };
  return rows;
}

}  // namespace

const io::SettingsTable<Settings>& settings_table() {
  static const auto table = make_table();
  return table;
}

void apply_effort(Settings& settings) {
  const auto level = std::ranges::find(levels, settings.effort);
  check(level != levels.end(), "effort: a known level");
  const auto i_level = static_cast<std::size_t>(level - levels.begin());
  for (const auto& row : effort_rows()) row.member(settings) = row.value[i_level];
}

}  // namespace elrom::study
