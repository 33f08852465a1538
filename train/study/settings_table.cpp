#include "settings_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "elrom/base/text.hpp"

namespace elrom::study {
namespace {

template <class Value>
using Member = std::function<Value&(Settings&)>;

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

// A number that TOML reads back as a float.
std::string float_text(double value) {
  const auto text = base::number(value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string list_text(const std::vector<std::string>& items) { return "[" + base::join(items, ", ") + "]"; }

template <class Value>
const Value& as_const(const Member<Value>& member, const Settings& settings) {
  return member(const_cast<Settings&>(settings));  // members only navigate; nothing is changed
}

SettingRow whole(std::string key, std::string meaning, Member<int> member, int low, int high = 100000000) {
  return {std::move(key), std::move(meaning),
          [=](Settings& s, const toml::node& node) {
            const auto value = node.value_exact<std::int64_t>();
            if (!value || *value < low || *value > high)
              throw fmt::format("a whole number from {} to {}", low, high);
            member(s) = static_cast<int>(*value);
          },
          [=](const Settings& s) { return std::to_string(as_const(member, s)); }};
}

SettingRow real(std::string key, std::string meaning, Member<double> member, double low, double high) {
  return {std::move(key), std::move(meaning),
          [=](Settings& s, const toml::node& node) {
            const auto value = node.value<double>();
            if (!value || !node.is_number() || !(*value >= low && *value <= high)) {
              throw fmt::format("a number from {} to {}", base::number(low), base::number(high));
            }
            member(s) = *value;
          },
          [=](const Settings& s) { return float_text(as_const(member, s)); }};
}

SettingRow flag(std::string key, std::string meaning, Member<bool> member) {
  return {std::move(key), std::move(meaning),
          [=](Settings& s, const toml::node& node) {
            const auto value = node.value_exact<bool>();
            if (!value) throw std::string("true or false");
            member(s) = *value;
          },
          [=](const Settings& s) { return std::string(as_const(member, s) ? "true" : "false"); }};
}

/// @param choices empty: any text
SettingRow word(std::string key, std::string meaning, Member<std::string> member,
                std::vector<std::string> choices = {}) {
  return {std::move(key), std::move(meaning),
          [=](Settings& s, const toml::node& node) {
            const auto value = node.value_exact<std::string>();
            if (!value) throw std::string("a text in quotes");
            if (!choices.empty() && std::ranges::find(choices, *value) == choices.end()) {
              throw "one of " + base::join(choices, ", ") + " (" + base::name_advice(*value, choices) + ")";
            }
            member(s) = *value;
          },
          [=](const Settings& s) { return quoted(as_const(member, s)); }};
}

SettingRow words(std::string key, std::string meaning, Member<std::vector<std::string>> member) {
  return {std::move(key), std::move(meaning),
          [=](Settings& s, const toml::node& node) {
            const auto* array = node.as_array();
            std::vector<std::string> values;
            for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
              const auto value = (*array)[i].value_exact<std::string>();
              if (!value)
                array = nullptr;
              else
                values.push_back(*value);
            }
            if (array == nullptr) throw std::string("a list of texts, for example [\"a\", \"b\"]");
            member(s) = values;
          },
          [=](const Settings& s) {
            std::vector<std::string> items;
            for (const auto& item : as_const(member, s)) items.push_back(quoted(item));
            return list_text(items);
          }};
}

using Numbers = std::vector<double>;

/// @param valid says no with what is expected
SettingRow numbers(std::string key, std::string meaning, Member<Numbers> member,
                   std::function<bool(const Numbers&)> valid, std::string expected) {
  return {std::move(key), std::move(meaning),
          [=](Settings& s, const toml::node& node) {
            const auto* array = node.as_array();
            Numbers values;
            for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
              const auto value = (*array)[i].value<double>();
              values.push_back(value && (*array)[i].is_number() ? *value : NAN);
            }
            if (array == nullptr || !valid(values)) throw expected;
            member(s) = values;
          },
          [=](const Settings& s) {
            std::vector<std::string> items;
            for (const double item : as_const(member, s)) items.push_back(float_text(item));
            return list_text(items);
          }};
}

SettingRow range(std::string key, std::string meaning, Member<Numbers> member, double low, double high) {
  return numbers(
      std::move(key), std::move(meaning), std::move(member),
      [=](const Numbers& v) { return v.size() == 2 && v[0] >= low && v[1] <= high && v[0] <= v[1]; },
      fmt::format("[smallest, largest] within {} and {}", base::number(low), base::number(high)));
}

SettingRow transforms() {
  return {"networks.transform", "transform of the targets by field: none, log or asinh, { field = \"log\" }",
          [](Settings& s, const toml::node& node) {
            const std::vector<std::string> known{"none", "log", "asinh"};
            std::map<std::string, std::string> values;
            bool valid = node.is_table();
            if (valid) {
              for (const auto& [field, value] : *node.as_table()) {
                const auto text = value.value_exact<std::string>().value_or("");
                valid = valid && std::ranges::find(known, text) != known.end();
                values[std::string(field.str())] = text;
              }
            }
            if (!valid) throw std::string("a table of field = \"none\" | \"log\" | \"asinh\"");
            s.networks.transform = values;
          },
          [](const Settings& s) {
            std::vector<std::string> items;
            for (const auto& [field, name] : s.networks.transform)
              items.push_back(quoted(field) + " = " + quoted(name));
            return "{" + base::join(items, ", ") + "}";
          }};
}

std::vector<SettingRow> make_rows() {
  const auto fractions = [](const Numbers& v) {
    return v.size() == 3 && v[0] > 0 && v[1] > 0 && v[2] >= 0 && std::abs(v[0] + v[1] + v[2] - 1) < 1e-9;
  };
  const auto ascending = [](const Numbers& v) {
    return std::ranges::is_sorted(v, std::less_equal<>{}) &&
           std::ranges::all_of(v, [](double x) { return x > 0; });
  };
  using S = Settings;
  return {
      word("effort", "what the run may cost: quick (minutes), standard (tens of minutes), thorough (hours)",
           [](S & s) -> auto& { return s.effort; }, {"quick", "standard", "thorough"}),
      word("method", "auto picks per field by cross-validation; or one method for every field",
           [](S & s) -> auto& { return s.method; },
           {"auto", "networks", "nearest", "linear", "pod_gp", "pod_gp_per_mode", "pod_rbf", "pod_mlp",
            "kernel"}),
      word(
          "store", "snapshot store, relative to the study's folder", [](S & s) -> auto& { return s.store; }),
      {"seed", "seed of every random stream",
       [](S& s, const toml::node& node) {
         const auto value = node.value_exact<std::int64_t>();
         if (!value) throw std::string("a whole number");
         s.seed = *value;
       },
       [](const S& s) { return std::to_string(s.seed); }},
      whole(
          "threads", "threads of every stage; 0: all", [](S & s) -> auto& { return s.threads; }, 0, 4096),
      word("device", "where LibTorch trains", [](S & s) -> auto& { return s.device; }, {"cpu", "cuda"}),
      words(
          "fields.names", "fields to build; empty: all of the store",
          [](S & s) -> auto& { return s.fields; }),
      words(
          "split.held_out", "cases never built with: names or patterns",
          [](S & s) -> auto& { return s.split.held_out; }),
      word("split.by", "case: planes of a case stay together; record: they do not (leaks)",
           [](S & s) -> auto& { return s.split.by; }, {"case", "record"}),
      numbers(
          "split.fractions", "train, validation, test", [](S & s) -> auto& { return s.split.fractions; },
          fractions, "three fractions that add up to 1, train and validation above 0"),
      flag(
          "symmetry.enabled", "use the declared mirror images",
          [](S & s) -> auto& { return s.symmetry.enabled; }),
      word("screen.method", "networks: build them for every column; fast: closed form",
           [](S & s) -> auto& { return s.screen.method; }, {"networks", "fast"}),
      whole(
          "screen.builds", "builds of every column", [](S & s) -> auto& { return s.screen.builds; }, 1, 100),
      whole(
          "screen.n_units", "hidden units of the default network",
          [](S & s) -> auto& { return s.screen.n_units; }, 1, 1024),
      whole(
          "screen.batch_size", "records a step", [](S & s) -> auto& { return s.screen.batch_size; }, 1,
          65536),
      real(
          "screen.learning_rate", "Adam's step", [](S & s) -> auto& { return s.screen.learning_rate; }, 1e-7,
          1),
      whole(
          "screen.max_epochs", "longest build", [](S & s) -> auto& { return s.screen.max_epochs; }, 1),
      whole(
          "screen.patience", "epochs without a better validation error",
          [](S & s) -> auto& { return s.screen.patience; }, 1),
      whole(
          "screen.features", "random features of the fast screen",
          [](S & s) -> auto& { return s.screen.features; }, 1, 8192),
      word("bands.scope", "field: a column has one band; plane: one in every plane",
           [](S & s) -> auto& { return s.bands.scope; }, {"field", "plane"}),
      numbers(
          "bands.edges", "error limits between bands", [](S & s) -> auto& { return s.bands.edges; },
          ascending, "ascending numbers above 0"),
      word("search.algorithm", "NLopt's search over the hyperparameters",
           [](S & s) -> auto& { return s.search.algorithm; },
           {"direct", "sobol_bobyqa", "sbplx", "crs2", "random"}),
      whole(
          "search.trials", "distinct trials a submodel", [](S & s) -> auto& { return s.search.trials; }, 1),
      flag(
          "search.prune", "give up hopeless trials (ASHA)", [](S & s) -> auto& { return s.search.prune; }),
      whole(
          "search.confirm", "best trials that are built again",
          [](S & s) -> auto& { return s.search.confirm; }, 0, 100),
      whole(
          "search.confirm_seeds", "builds of each of those",
          [](S & s) -> auto& { return s.search.confirm_seeds; }, 1, 100),
      whole(
          "search.max_epochs", "longest trial", [](S & s) -> auto& { return s.search.max_epochs; }, 1),
      whole(
          "search.patience", "epochs without a better validation error",
          [](S & s) -> auto& { return s.search.patience; }, 1),
      range(
          "search.learning_rate", "range", [](S & s) -> auto& { return s.search.learning_rate; }, 1e-7, 1),
      range(
          "search.n_layers", "range of hidden layers", [](S & s) -> auto& { return s.search.n_layers; }, 1,
          16),
      range(
          "search.n_units", "range of units a layer", [](S & s) -> auto& { return s.search.n_units; }, 1,
          4096),
      range(
          "search.batch_size", "range of records a step", [](S & s) -> auto& { return s.search.batch_size; },
          1, 65536),
      range(
          "search.weight_decay", "range, searched with search.regularise",
          [](S & s) -> auto& { return s.search.weight_decay; }, 1e-12, 10),
      range(
          "search.dropout", "range, searched with search.regularise",
          [](S & s) -> auto& { return s.search.dropout; }, 0, 0.9),
      flag(
          "search.regularise", "search weight decay and dropout too",
          [](S & s) -> auto& { return s.search.regularise; }),
      whole(
          "fit.builds", "builds of every submodel", [](S & s) -> auto& { return s.fit.builds; }, 1, 100),
      word("fit.combine", "what a submodel answers with", [](S & s) -> auto& { return s.fit.combine; },
           {"mean", "best"}),
      whole(
          "fit.max_epochs", "longest build", [](S & s) -> auto& { return s.fit.max_epochs; }, 1),
      whole(
          "fit.patience", "epochs without a better validation error",
          [](S & s) -> auto& { return s.fit.patience; }, 1),
      word("networks.plane_encoding", "how a network is told the plane",
           [](S & s) -> auto& { return s.networks.plane_encoding; }, {"index", "fourier", "one_hot"}),
      word("networks.activation", "of the hidden layers",
           [](S & s) -> auto& { return s.networks.activation; }, {"relu", "tanh", "silu"}),
      word("networks.targets", "standardised by column (the source) or by cell",
           [](S & s) -> auto& { return s.networks.targets; }, {"column", "cell"}),
      flag(
          "networks.mirrors", "train networks on mirror images too",
          [](S & s) -> auto& { return s.networks.mirrors; }),
      flag(
          "networks.average", "average what networks answer over mirror images",
          [](S & s) -> auto& { return s.networks.average; }),
      word("networks.relevance",
           "scale the inputs by their weight in a ridge fit, or by a process's length scales",
           [](S & s) -> auto& { return s.networks.relevance; }, {"none", "linear", "gp"}),
      transforms(),
      words(
          "peers.methods", "fitted beside the model, each to a bundle of its own",
          [](S & s) -> auto& { return s.peers.methods; }),
      flag(
          "peers.networks", "networks compete in auto and get a bundle of their own",
          [](S & s) -> auto& { return s.peers.networks; }),
      whole(
          "peers.folds",
          "folds by load of auto's cross-validation; intervals are scored on twice as many, spread ones",
          [](S & s) -> auto& { return s.peers.folds; }, 2, 1000),
  };
}

// What each effort level changes: quick, standard, thorough.
struct EffortRow {
  Member<int> member;
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
      {[](S& s) -> int& { return s.search.max_epochs; }, {15, 24, 120}},
      {[](S& s) -> int& { return s.search.patience; }, {3, 4, 12}},
      {[](S& s) -> int& { return s.fit.max_epochs; }, {30, 60, 400}},
      {[](S& s) -> int& { return s.fit.patience; }, {5, 8, 30}},
      {[](S& s) -> int& { return s.peers.folds; }, {6, 6, 10}},
  };
  return rows;
}

}  // namespace

std::string SettingRow::section() const {
  const auto dot = key.find('.');
  return dot == std::string::npos ? std::string() : key.substr(0, dot);
}

std::string SettingRow::name() const {
  const auto dot = key.find('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

const std::vector<SettingRow>& setting_rows() {
  static const std::vector<SettingRow> rows = make_rows();
  return rows;
}

const SettingRow* find_setting(std::string_view key) {
  const auto& rows = setting_rows();
  const auto found = std::ranges::find(rows, key, &SettingRow::key);
  return found == rows.end() ? nullptr : &*found;
}

void apply_effort(Settings& settings, const std::string& effort) {
  const std::vector<std::string> levels{"quick", "standard", "thorough"};
  const auto level = std::ranges::find(levels, effort);
  if (level == levels.end())
    throw "one of quick, standard, thorough (" + base::name_advice(effort, levels) + ")";
  const auto i_level = static_cast<std::size_t>(level - levels.begin());
  for (const auto& row : effort_rows()) row.member(settings) = row.value[i_level];
  settings.effort = effort;
}

}  // namespace elrom::study
