#pragma once
// One row a setting of a plain struct S: key, meaning, how it is read from TOML and written back. Whatever is
// told by a TOML file (a study, a furnace, a scene) has one table, and reading, writing, help and the advice
// for a mistaken key follow from it.
//
//   io::SettingsTable<Pump> table;
//   table.real("flow.rate_kg_per_s", "what it delivers", [](auto& p) -> auto& { return p.rate; }, 0, 100);
//   table.word("drive", "what turns it", [](auto& p) -> auto& { return p.drive; }, {"belt", "shaft"});
//
// A key's part before its last dot is its section. Sections are written in the order of the rows.
//
// Thread rule: const use from any thread.

#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <type_traits>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/setting_value.hpp"

namespace elrom::io {

template <class S>
struct SettingRow {
  std::string key;  ///< "screen.builds"
  std::string meaning;
  std::function<void(S&, const SettingValue&)> read;
  std::function<std::string(const S&)> write;  ///< as TOML; empty: not set, and so not written
  bool is_tables = false;                      ///< a list of tables of its own, [[key]]
  bool is_required = false;

  [[nodiscard]] std::string section() const {  ///< "screen"; empty for keys of the root
    const auto dot = key.rfind('.');
    return dot == std::string::npos ? std::string() : key.substr(0, dot);
  }
  [[nodiscard]] std::string name() const { return key.substr(key.rfind('.') + 1); }  ///< "builds"
  void require() { is_required = true; }
};

template <class S>
class SettingsTable {
 public:
  using Row = SettingRow<S>;
  static constexpr std::int64_t most = 100'000'000;

  // In all of these, `member` gives the member that a row is about: [](auto& s) -> auto& { return s.x; }

  template <class Member>
  Row& whole(std::string key, std::string meaning, Member member, std::int64_t low,
             std::int64_t high = most) {
    return simple(std::move(key), std::move(meaning), member,
                  [=](const SettingValue& value) { return read_whole(value, low, high); });
  }
  template <class Member>
  Row& real(std::string key, std::string meaning, Member member, double low, double high) {
    return simple(std::move(key), std::move(meaning), member,
                  [=](const SettingValue& value) { return read_real(value, low, high); });
  }
  /// A number in SI, or a text with a unit; written in SI.
  template <class Member>
  Row& quantity(std::string key, std::string meaning, Member member, std::string si, double low,
                double high) {
    return simple(std::move(key), std::move(meaning), member,
                  [=](const SettingValue& value) { return read_quantity(value, si, low, high); });
  }
  /// [x, y, z] of such. @param member a struct of three doubles
  template <class Member>
  Row& vector(std::string key, std::string meaning, Member member, std::string si) {
    return add({std::move(key), std::move(meaning),
                [=](S& s, const SettingValue& value) {
                  const auto found = read_quantities(value, si, 3);
                  member(s) = {found[0], found[1], found[2]};
                },
                [=](const S& s) {
                  const auto& [x, y, z] = member(s);
                  return toml_text(std::vector<double>{x, y, z});
                }});
  }
  /// n of such, or none: []. @param member a list; not written where it is empty
  template <class Member>
  Row& quantities(std::string key, std::string meaning, Member member, std::string si, std::size_t n) {
    return add({std::move(key), std::move(meaning),
                [=](S& s, const SettingValue& value) {
                  const bool none = value.list() != nullptr && value.list()->empty();
                  member(s) = none ? std::vector<double>{} : read_quantities(value, si, n);
                },
                [=](const S& s) { return member(s).empty() ? std::string() : toml_text(member(s)); }});
  }
  template <class Member>
  Row& flag(std::string key, std::string meaning, Member member) {
    return simple(std::move(key), std::move(meaning), member, read_flag);
  }
  /// @param choices empty: any text. Of a member that is a char, each is one letter
  template <class Member>
  Row& word(std::string key, std::string meaning, Member member, std::vector<std::string> choices = {}) {
    return simple(std::move(key), std::move(meaning), member,
                  [=](const SettingValue& value) { return read_word(value, choices); });
  }
  /// The member may be optional: it is then left alone, and not written, where no file names it.
  template <class Member>
  Row& words(std::string key, std::string meaning, Member member) {
    return simple(std::move(key), std::move(meaning), member, read_words);
  }
  /// @param valid says whether the numbers can be taken, `expected` what they should be
  template <class Member, class Valid>
  Row& numbers(std::string key, std::string meaning, Member member, Valid valid, std::string expected) {
    return simple(std::move(key), std::move(meaning), member, [=](const SettingValue& value) {
      const auto found = read_numbers(value, expected);
      if (!valid(found)) value.refuse(expected);
      return found;
    });
  }
  /// [smallest, largest]
  template <class Member>
  Row& range(std::string key, std::string meaning, Member member, double low, double high) {
    return numbers(
        std::move(key), std::move(meaning), member,
        [=](const std::vector<double>& v) {
          return v.size() == 2 && v[0] >= low && v[1] <= high && v[0] <= v[1];
        },
        "[smallest, largest] within " + base::number(low) + " and " + base::number(high));
  }
  /// [["a", "b"], ...]
  template <class Member>
  Row& pairs(std::string key, std::string meaning, Member member) {
    return simple(std::move(key), std::move(meaning), member, read_pairs);
  }
  /// A table of words under names of the user's: { pressure = "log" }
  template <class Member>
  Row& choices_by_name(std::string key, std::string meaning, Member member,
                       std::vector<std::string> choices) {
    return simple(std::move(key), std::move(meaning), member,
                  [=](const SettingValue& value) { return read_choices_by_name(value, choices); });
  }
  /// A list of tables, [[key]]. @param fault what should be otherwise in one of them; empty: nothing
  template <class Member, class Inner>
  Row& tables(std::string key, std::string meaning, Member member, const SettingsTable<Inner>& inner,
              std::function<std::string(const std::type_identity_t<Inner>&)> fault = {}) {
    const auto table = std::make_shared<const SettingsTable<Inner>>(inner);
    const auto take = [=](S& s, const SettingValue& value) {
      if (value.list() == nullptr) value.refuse("[[" + value.key() + "]] tables");
      std::vector<Inner> items;
      for (const auto& item : *value.list()) {
        if (item.table() == nullptr) item.refuse("[[" + value.key() + "]] tables");
        table->read(items.emplace_back(), item);
        const auto expected = fault ? fault(items.back()) : std::string();
        if (!expected.empty()) item.refuse(expected);
      }
      member(s) = std::move(items);
    };
    const auto give = [=](const S& s) {
      std::string text;
      for (const auto& item : member(s)) text += "\n[[" + key + "]]\n" + table->write(item);
      return text;
    };
    return add({key, std::move(meaning), take, give, true});
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  /// Null: no such key.
  [[nodiscard]] const Row* find(std::string_view key) const {
    const auto found = std::ranges::find(rows_, key, &Row::key);
    return found == rows_.end() ? nullptr : &*found;
  }

  /// Sets what the file names; the rest stays as it is. @param root as parsed: a table
  /// @throws UsageError or InputError for an unknown key, with the nearest one, for a value that its row
  /// refuses, and for a required key that is missing; all with file and line
  void read(S& settings, const SettingValue& root) const {
    std::set<std::string> seen;
    read_members(settings, root, "", seen);
    for (const auto& row : rows_)
      if (row.is_required && !seen.contains(row.key)) root.refuse_without(row.key);
  }

  /// All of it as TOML that reads back to the same; `section` ("screen") limits it to one.
  [[nodiscard]] std::string write(const S& settings, std::string_view section = {}) const {
    std::string text, open;
    for (const auto& row : rows_) {
      if (!section.empty() && row.section() != section) continue;
      const auto value = row.write(settings);
      if (value.empty()) continue;
      if (row.is_tables) {
        text += value;
        continue;
      }
      if (row.section() != open) text += "\n[" + (open = row.section()) + "]\n";
      text += row.name() + " = " + value + "\n";
    }
    return text;
  }

 private:
  Row& add(Row row) {
    // TOML has no way back into a section, nor out of a list of tables.
    const auto same = [&](const Row& other) { return !other.is_tables && other.section() == row.section(); };
    const bool goes_on = !rows_.empty() && same(rows_.back());
    const bool is_new = std::ranges::none_of(rows_, same) && (rows_.empty() || !row.section().empty());
    check(row.is_tables || goes_on || is_new, "settings table: a section's rows follow each other");
    check(find(row.key) == nullptr, "settings table: one row a key");
    return rows_.emplace_back(std::move(row));
  }

  template <class Member, class Read>
  Row& simple(std::string key, std::string meaning, Member member, Read parse) {
    using Value = std::remove_reference_t<decltype(member(std::declval<S&>()))>;
    return add({std::move(key), std::move(meaning),
                [=](S& s, const SettingValue& value) {
                  if constexpr (std::is_same_v<Value, char>)
                    member(s) = parse(value).front();
                  else
                    member(s) = static_cast<Value>(parse(value));
                },
                [=](const S& s) { return text_of(member(s)); }});
  }

  template <class Value>
  static std::string text_of(const Value& value) {
    if constexpr (requires { value.has_value(); })
      return value.has_value() ? text_of(*value) : std::string();
    else if constexpr (std::is_same_v<Value, char>)
      return toml_text(std::string(1, value));
    else if constexpr (std::is_integral_v<Value> && !std::is_same_v<Value, bool>)
      return toml_text(static_cast<std::int64_t>(value));
    else
      return toml_text(value);
  }

  [[nodiscard]] bool is_section(const std::string& key) const {
    return std::ranges::any_of(
        rows_, [&](const Row& row) { return row.section() == key || row.section().starts_with(key + "."); });
  }

  void read_members(S& settings, const SettingValue& table, const std::string& prefix,
                    std::set<std::string>& seen) const {
    for (const auto& value : *table.table()) {
      const auto key = prefix + value.name();
      if (const auto* row = find(key)) {
        row->read(settings, value);
        seen.insert(key);
      } else if (value.table() != nullptr && is_section(key)) {
        read_members(settings, value, key + ".", seen);
      } else {
        value.refuse_name(advice(key));
      }
    }
  }

  [[nodiscard]] std::string advice(const std::string& key) const {
    std::vector<std::string> all, near;
    for (const auto& row : rows_) {
      all.push_back(row.key);
      if (!row.section().empty()) all.push_back(row.section());
    }
    if (const auto closest = base::closest_name(key, all)) return "did you mean '" + *closest + "'?";
    const auto dot = key.rfind('.');
    const auto section = dot == std::string::npos ? std::string() : key.substr(0, dot);
    for (const auto& row : rows_) {
      if (row.name() == key.substr(dot + 1)) return "did you mean '" + row.key + "'?";
      if (row.section() == section) near.push_back(row.key);
    }
    return near.empty() ? base::name_advice(key, all) : "known there are: " + base::join(near, ", ");
  }

  std::vector<Row> rows_;
};

}  // namespace elrom::io
