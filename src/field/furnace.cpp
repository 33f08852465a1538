#include "elrom/field/furnace.hpp"

#include <algorithm>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/csv.hpp"
#include "elrom/io/settings_table.hpp"

namespace elrom::field {

namespace {

constexpr double highest = 1000;  // of anything in a furnace [m]

io::SettingsTable<MirrorDeclaration> make_mirror_table() {
  io::SettingsTable<MirrorDeclaration> t;
  t.word(
      "name", "for messages", [](auto& m) -> auto& { return m.name; });
  t.word("axis", "coordinate that changes its sense", [](auto& m) -> auto& { return m.axis; }, {"x", "y"})
      .require();
  t.pairs(
      "swap", "patterns of inputs that change places", [](auto& m) -> auto& { return m.swap; });
  t.words(
      "complement", "inputs q that become 1 - q", [](auto& m) -> auto& { return m.complement; });
  return t;
}

io::SettingsTable<Opening> opening_table() {
  io::SettingsTable<Opening> t;
  t.word(
       "inputs", "name or pattern of the gas flows", [](auto& o) -> auto& { return o.inputs; })
      .require();
  t.word(
      "kind", "what enters", [](auto& o) -> auto& { return o.kind; }, opening_kinds());
  t.real(
       "low_m", "lower edge", [](auto& o) -> auto& { return o.low_m; }, 0, highest)
      .require();
  t.real(
       "high_m", "upper edge", [](auto& o) -> auto& { return o.high_m; }, 0, highest)
      .require();
  return t;
}

std::string edge_fault(const Opening& opening) {
  return opening.low_m <= opening.high_m ? "" : "low_m at or below high_m";
}

io::SettingsTable<Furnace> make_furnace_table() {
  constexpr double endless = std::numeric_limits<double>::infinity();
  io::SettingsTable<Furnace> t;
  t.word(
       "name", "of the furnace", [](auto& f) -> auto& { return f.name; })
      .require();
  t.real(
       "solids.density_kg_per_m3", "of the material", [](auto& f) -> auto& { return f.solid_density; }, 1,
       50000)
      .require();
  t.real(
       "solids.packing_limit", "largest volume fraction", [](auto& f) -> auto& { return f.packing_limit; },
       0.01, 1)
      .require();
  t.real(
      "outlet.low_m", "lower edge of the outlet", [](auto& f) -> auto& { return f.outlet_low_m; }, 0,
      endless);
  t.words(
      "cases.held_out", "never trained on: names or patterns", [](auto& f) -> auto& { return f.held_out; });
  t.words(
      "cases.repeats", "those of them that tell the noise", [](auto& f) -> auto& { return f.repeats; });
  t.word(
      "words.case", "what one case is called", [](auto& f) -> auto& { return f.words.one; });
  t.word(
      "words.cases", "what several are called", [](auto& f) -> auto& { return f.words.many; });
  t.word(
      "words.reference", "what computed the cases", [](auto& f) -> auto& { return f.words.truth; });
  t.tables(
      "opening", "where gas enters", [](auto& f) -> auto& { return f.openings; }, opening_table(),
      edge_fault);
  t.tables(
      "mirror", "mirror images", [](auto& f) -> auto& { return f.mirrors; }, mirror_table());
  return t;
}

const io::SettingsTable<Furnace>& furnace_table() {
  static const auto table = make_furnace_table();
  return table;
}

// What the audit takes for a gas flow.
bool is_flow(const InputInfo& input) { return input.unit == "kg/s"; }

}  // namespace

const std::vector<std::string>& opening_kinds() {
  static const std::vector<std::string> kinds{"primary_air", "secondary_air",  "fuel", "burner",
                                              "return",      "heat_exchanger", "other"};
  return kinds;
}

const io::SettingsTable<MirrorDeclaration>& mirror_table() {
  static const auto table = make_mirror_table();
  return table;
}

std::string Words::case_word(std::size_t n) const {
  const auto single = one.value_or("case");
  return n == 1 ? single : many.value_or(single + "s");
}

std::string Words::reference() const { return truth.value_or("reference"); }

bool Furnace::is_repeat(std::string_view case_name) const {
  return std::ranges::any_of(repeats, [&](const auto& pattern) { return base::matches(case_name, pattern); });
}

std::vector<FieldInfo> Furnace::limited(std::vector<FieldInfo> fields) const {
  for (auto& field : fields)
    if (field.name == "solid_volume_fraction") field.upper = packing_limit;
  return fields;
}

Furnace parse_furnace(std::string_view text, const std::string& where) {
  Furnace furnace;
  furnace_table().read(furnace, io::parse_settings(text, where, io::SettingsFault::input));
  return furnace;
}

Furnace read_furnace(const std::filesystem::path& file) {
  return parse_furnace(io::read_small_text(file), file.string());
}

std::string to_toml(const Furnace& furnace) { return furnace_table().write(furnace); }

void expect_fits(const Furnace& furnace, const InputSchema& schema, const std::string& where) {
  std::vector<std::string> flows, patterns(schema.size());
  for (const auto& input : schema.inputs())
    if (is_flow(input)) flows.push_back(input.name);
  for (const auto& opening : furnace.openings) {
    bool any = false;
    for (std::size_t i = 0; i < schema.size(); ++i) {
      if (!is_flow(schema[i]) || !base::matches(schema[i].name, opening.inputs)) continue;
      if (!patterns[i].empty())
        throw InputError({.what = "'" + schema[i].name + "' enters by two openings",
                          .where = where,
                          .found = "'" + patterns[i] + "' and '" + opening.inputs + "'"});
      patterns[i] = opening.inputs;
      any = true;
    }
    if (!any)
      throw InputError({.what = "opening '" + opening.inputs + "' matches no gas flow of the cases",
                        .where = where,
                        .advice = base::name_advice(opening.inputs, flows)});
  }
}

std::vector<std::string> flows_without_opening(const Furnace& furnace, const InputSchema& schema) {
  std::vector<std::string> flows;
  for (const auto& input : schema.inputs()) {
    const auto names = [&](const Opening& opening) { return base::matches(input.name, opening.inputs); };
    if (is_flow(input) && std::ranges::none_of(furnace.openings, names)) flows.push_back(input.name);
  }
  return flows;
}

}  // namespace elrom::field
