#include "elrom/io/setting_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "toml.hpp"

namespace elrom::io {

namespace {

[[noreturn]] void fail(SettingsFault fault, const Problem& problem) {
  if (fault == SettingsFault::input) throw InputError(problem);
  throw UsageError(problem);
}

template <class Items, class Text>
std::string joined(const Items& items, const Text& text) {
  std::vector<std::string> parts;
  for (const auto& item : items) parts.push_back(text(item));
  return base::join(parts, ", ");
}

std::string pair_text(const std::pair<std::string, std::string>& pair) {
  return "[" + toml_text(pair.first) + ", " + toml_text(pair.second) + "]";
}

}  // namespace

/// toml++'s tree into ours.
class SettingsParser {
 public:
  enum class Source { file, command_line };
  SettingsParser(const std::string& where, SettingsFault fault, Source kind = Source::file)
      : source_(std::make_shared<const SettingValue::Source>(SettingValue::Source{where, fault})),
        has_lines_(kind == Source::file) {}

  [[nodiscard]] SettingValue parse(std::string_view text) const {
    try {
      return value_of(toml::parse(text, source_->file), "", "");
    } catch (const toml::parse_error& error) {
      fail(source_->fault, {.what = std::string("no valid TOML (") + std::string(error.description()) + ")",
                            .where = fmt::format("{}:{}", source_->file, error.source().begin.line)});
    }
  }

 private:
  [[nodiscard]] SettingValue value_of(const toml::node& node, const std::string& key,
                                      const std::string& name) const {
    SettingValue value;
    value.key_ = key;
    value.name_ = name;
    value.line_ = has_lines_ ? node.source().begin.line : 0;
    value.source_ = source_;
    if (const auto* table = node.as_table()) {
      value.value_ = SettingValue::Table{members_of(*table, key)};
    } else if (const auto* array = node.as_array()) {
      SettingValue::List list;
      for (const auto& item : *array) list.push_back(value_of(item, key, name));
      value.value_ = std::move(list);
    } else if (const auto flag = node.value_exact<bool>()) {
      value.value_ = *flag;
    } else if (const auto whole = node.value_exact<std::int64_t>()) {
      value.value_ = *whole;
    } else if (const auto real = node.value_exact<double>()) {
      value.value_ = *real;
    } else if (auto text = node.value_exact<std::string>()) {
      value.value_ = std::move(*text);
    } else {
      value.value_ = SettingValue::Other{"a date or time"};
    }
    return value;
  }

  [[nodiscard]] SettingValue::List members_of(const toml::table& table, const std::string& key) const {
    SettingValue::List members;
    for (const auto& [text, node] : table) {
      const std::string name(text.str());
      members.push_back(value_of(node, (key.empty() ? "" : key + ".") + name, name));
    }
    return members;
  }

  std::shared_ptr<const SettingValue::Source> source_;
  bool has_lines_;
};

std::string SettingValue::where() const {
  return line_ > 0 ? fmt::format("{}:{}", source_->file, line_) : source_->file;
}

std::optional<double> SettingValue::real() const {
  if (const auto* value = std::get_if<double>(&value_)) return *value;
  if (const auto* value = whole()) return static_cast<double>(*value);
  return std::nullopt;
}

const SettingValue::List* SettingValue::list() const { return std::get_if<List>(&value_); }

const SettingValue::List* SettingValue::table() const {
  const auto* table = std::get_if<Table>(&value_);
  return table != nullptr ? &table->members : nullptr;
}

const SettingValue* SettingValue::member(std::string_view name) const {
  const auto* members = table();
  if (members == nullptr) return nullptr;
  const auto found =
      std::ranges::find_if(*members, [&](const SettingValue& member) { return member.name() == name; });
  return found == members->end() ? nullptr : &*found;
}

std::string SettingValue::shown() const {
  if (const auto* items = list())
    return "[" + joined(*items, [](const SettingValue& item) { return item.shown(); }) + "]";
  if (table() != nullptr) return "a table";
  if (const auto* other = std::get_if<Other>(&value_)) return other->shown;
  if (const auto* value = flag()) return toml_text(*value);
  if (const auto* value = whole()) return toml_text(*value);
  if (const auto* value = text()) return toml_text(*value);
  return toml_text(std::get<double>(value_));
}

void SettingValue::refuse(const std::string& expected) const {
  fail(source_->fault, {.what = "setting " + key_, .where = where(), .found = shown(), .expected = expected});
}

void SettingValue::refuse_name(const std::string& advice) const {
  fail(source_->fault, {.what = "unknown setting '" + key_ + "'", .where = where(), .advice = advice});
}

void SettingValue::refuse_without(const std::string& missing) const {
  fail(source_->fault,
       {.what = "missing setting '" + (key_.empty() ? "" : key_ + ".") + missing + "'", .where = where()});
}

SettingValue parse_settings(std::string_view text, const std::string& file, SettingsFault fault) {
  return SettingsParser(file, fault).parse(text);
}

SettingValue parse_override(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw UsageError({.what = "no setting", .where = "--set", .found = text, .expected = "key=value"});
  }
  const auto key = base::trim(text.substr(0, equals)), value = base::trim(text.substr(equals + 1));
  const SettingsParser parser("--set " + text, SettingsFault::usage, SettingsParser::Source::command_line);
  try {
    return parser.parse(key + " = " + value);
  } catch (const UsageError&) {
    return parser.parse(key + " = " + toml_text(value));
  }
}

bool read_flag(const SettingValue& value) {
  if (value.flag() == nullptr) value.refuse("true or false");
  return *value.flag();
}

std::int64_t read_whole(const SettingValue& value, std::int64_t low, std::int64_t high) {
  const auto* number = value.whole();
  if (number != nullptr && *number >= low && *number <= high) return *number;
  const bool any = low == std::numeric_limits<std::int64_t>::min();
  value.refuse(any ? "a whole number" : fmt::format("a whole number from {} to {}", low, high));
}

double read_real(const SettingValue& value, double low, double high) {
  const auto number = value.real();
  if (number && *number >= low && *number <= high) return *number;
  value.refuse(fmt::format("a number from {} to {}", base::number(low), base::number(high)));
}

double read_quantity(const SettingValue& value, std::string_view si, double low, double high) {
  const auto expected = [&] {
    const bool is_bounded = low > -HUGE_VAL || high < HUGE_VAL;
    return "a number in " + std::string(si) + " or a text with a unit, \"1 " + std::string(si) + "\"" +
           (is_bounded ? ", from " + base::number(low) + " to " + base::number(high) : "");
  };
  std::optional<double> number = value.real();
  if (value.text() != nullptr) {
    try {
      number = base::quantity(*value.text(), si);
    } catch (const InputError& error) {
      value.refuse(expected() + " (" + error.what() + ")");
    }
  }
  if (number && *number >= low && *number <= high && std::isfinite(*number)) return *number;
  value.refuse(expected());
}

std::vector<double> read_quantities(const SettingValue& value, std::string_view si, std::size_t n) {
  const auto* list = value.list();
  if (list == nullptr || list->size() != n)
    value.refuse("a list of " + std::to_string(n) + " numbers in " + std::string(si) +
                 ", or texts with a unit");
  std::vector<double> numbers;
  for (const auto& item : *list) numbers.push_back(read_quantity(item, si, -HUGE_VAL, HUGE_VAL));
  return numbers;
}

std::string read_word(const SettingValue& value, const std::vector<std::string>& choices) {
  const auto* text = value.text();
  if (text == nullptr) value.refuse("a text in quotes");
  if (!choices.empty() && std::ranges::find(choices, *text) == choices.end())
    value.refuse("one of " + base::join(choices, ", ") + " (" + base::name_advice(*text, choices) + ")");
  return *text;
}

std::vector<std::string> read_words(const SettingValue& value) {
  std::vector<std::string> words;
  const std::string expected = "a list of texts, for example [\"a\", \"b\"]";
  if (value.list() == nullptr) value.refuse(expected);
  for (const auto& item : *value.list()) {
    if (item.text() == nullptr) value.refuse(expected);
    words.push_back(*item.text());
  }
  return words;
}

std::vector<double> read_numbers(const SettingValue& value, const std::string& expected) {
  std::vector<double> numbers;
  if (value.list() == nullptr) value.refuse(expected);
  for (const auto& item : *value.list()) {
    if (!item.real()) value.refuse(expected);
    numbers.push_back(*item.real());
  }
  return numbers;
}

std::vector<std::pair<std::string, std::string>> read_pairs(const SettingValue& value) {
  std::vector<std::pair<std::string, std::string>> pairs;
  const std::string expected = "a list of pairs, for example [[\"*_left\", \"*_right\"]]";
  if (value.list() == nullptr) value.refuse(expected);
  for (const auto& item : *value.list()) {
    const auto* pair = item.list();
    if (pair == nullptr || pair->size() != 2 || (*pair)[0].text() == nullptr || (*pair)[1].text() == nullptr)
      value.refuse(expected);
    pairs.emplace_back(*(*pair)[0].text(), *(*pair)[1].text());
  }
  return pairs;
}

std::map<std::string, std::string> read_choices_by_name(const SettingValue& value,
                                                        const std::vector<std::string>& choices) {
  if (value.table() == nullptr) value.refuse("a table of name = \"" + base::join(choices, "\" | \"") + "\"");
  std::map<std::string, std::string> words;
  for (const auto& member : *value.table()) words[member.name()] = read_word(member, choices);
  return words;
}

std::string toml_text(bool value) { return value ? "true" : "false"; }

std::string toml_text(std::int64_t value) { return std::to_string(value); }

// TOML tells a number with a point from a whole one.
std::string toml_text(double value) {
  const auto text = base::number(value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string toml_text(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7f)
      text += fmt::format("\\u{:04X}", code);
    else
      text += c;
  }
  return text + "\"";
}

std::string toml_text(const std::vector<std::string>& values) {
  return "[" + joined(values, [](const std::string& value) { return toml_text(value); }) + "]";
}

std::string toml_text(const std::vector<double>& values) {
  return "[" + joined(values, [](double value) { return toml_text(value); }) + "]";
}

std::string toml_text(const std::vector<std::pair<std::string, std::string>>& values) {
  return "[" + joined(values, pair_text) + "]";
}

std::string toml_text(const std::map<std::string, std::string>& values) {
  return "{" +
         joined(values,
                [](const auto& entry) { return toml_text(entry.first) + " = " + toml_text(entry.second); }) +
         "}";
}

}  // namespace elrom::io
