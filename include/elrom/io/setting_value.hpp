#pragma once
// Settings as they stand in a TOML file: values that know their key and their line, so that whoever refuses
// one can name both. What a file may hold is said by a table of io/settings_table.hpp.
//
// Thread rule: plain data.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace elrom::io {

/// What a wrong file is to the program: a wrong setting (UsageError) or a wrong input (InputError).
enum class SettingsFault { usage, input };

class SettingValue {
 public:
  using List = std::vector<SettingValue>;

  [[nodiscard]] const std::string& key() const { return key_; }    ///< from the root: "screen.builds"
  [[nodiscard]] const std::string& name() const { return name_; }  ///< its last part: "builds"
  [[nodiscard]] std::string where() const;                         ///< "study.toml:12"

  // Null, or nothing, for a value of another type.
  [[nodiscard]] const bool* flag() const { return std::get_if<bool>(&value_); }
  [[nodiscard]] const std::int64_t* whole() const { return std::get_if<std::int64_t>(&value_); }
  [[nodiscard]] const std::string* text() const { return std::get_if<std::string>(&value_); }
  [[nodiscard]] std::optional<double> real() const;  ///< of whole numbers too
  [[nodiscard]] const List* list() const;
  [[nodiscard]] const List* table() const;                                ///< members, by name
  [[nodiscard]] const SettingValue* member(std::string_view name) const;  ///< null: no table, or not in it

  /// @throws UsageError or InputError: "setting <key> in <file:line>: found <value>, expected <expected>"
  [[noreturn]] void refuse(const std::string& expected) const;
  /// @throws UsageError or InputError: "unknown setting '<key>' in <file:line>; <advice>"
  [[noreturn]] void refuse_name(const std::string& advice) const;
  /// Of a table that lacks a member. @throws UsageError or InputError
  [[noreturn]] void refuse_without(const std::string& missing) const;

 private:
  struct Source {
    std::string file;
    SettingsFault fault;
  };
  struct Table {
    List members;
  };
  struct Other {
    std::string shown;  ///< a date or a time: nothing of ours
  };
  friend class SettingsParser;
  [[nodiscard]] std::string shown() const;

  std::variant<bool, std::int64_t, double, std::string, List, Table, Other> value_ = false;
  std::string key_, name_;
  std::size_t line_ = 0;
  std::shared_ptr<const Source> source_;
};

/// @param file for messages. @throws UsageError or InputError, as `fault` says, with file and line
[[nodiscard]] SettingValue parse_settings(std::string_view text, const std::string& file,
                                          SettingsFault fault = SettingsFault::usage);
/// "screen.builds=3" of a command line: the value as TOML or, where it is none, as a bare word.
/// @throws UsageError when it is no key=value
[[nodiscard]] SettingValue parse_override(const std::string& text);

// Values by type. @throws UsageError or InputError from SettingValue::refuse()
[[nodiscard]] bool read_flag(const SettingValue& value);
[[nodiscard]] std::int64_t read_whole(const SettingValue& value, std::int64_t low, std::int64_t high);
[[nodiscard]] double read_real(const SettingValue& value, double low, double high);
/// @param choices empty: any text
[[nodiscard]] std::string read_word(const SettingValue& value, const std::vector<std::string>& choices);
/// A number in SI, or a text with a unit: "315 um". @param si the unit of the dimension wanted, "m"
[[nodiscard]] double read_quantity(const SettingValue& value, std::string_view si, double low, double high);
/// A list of `n` of them.
[[nodiscard]] std::vector<double> read_quantities(const SettingValue& value, std::string_view si,
                                                  std::size_t n);
[[nodiscard]] std::vector<std::string> read_words(const SettingValue& value);
/// @param expected said of a value that is no list of numbers
[[nodiscard]] std::vector<double> read_numbers(const SettingValue& value, const std::string& expected);
[[nodiscard]] std::vector<std::pair<std::string, std::string>> read_pairs(const SettingValue& value);
[[nodiscard]] std::map<std::string, std::string> read_choices_by_name(
    const SettingValue& value, const std::vector<std::string>& choices);

// The same as TOML that reads back to the same value.
[[nodiscard]] std::string toml_text(bool value);
[[nodiscard]] std::string toml_text(std::int64_t value);
[[nodiscard]] std::string toml_text(double value);
[[nodiscard]] std::string toml_text(const std::string& value);
[[nodiscard]] std::string toml_text(const std::vector<std::string>& values);
[[nodiscard]] std::string toml_text(const std::vector<double>& values);
[[nodiscard]] std::string toml_text(const std::vector<std::pair<std::string, std::string>>& values);
[[nodiscard]] std::string toml_text(const std::map<std::string, std::string>& values);

}  // namespace elrom::io
