#pragma once
// Command lines of all programs: options, subcommands, help, and what is said of a
// slip. CLI11 does the work inside; functions have its names. It is not seen from here,
// since it costs every source that reads it two to four seconds of compiling.
//
//   cli::App app("What it does.", "elrom-example");
//   auto* command = app.add_subcommand("copy", "Copies.");
//   command->add_option("--output", path, "Where to")->type_name("FILE")->required();
//   if (const auto status = app.parse(argc, argv)) return *status;
//
// Thread rule: one thread.

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace elrom::cli {

/// What a value must be beyond its type.
struct Check {
  std::string shown;     ///< in --help, behind the value's name: "POSITIVE"
  std::string expected;  ///< in an error: "a number above 0"
  std::function<bool(const std::string& value)> holds;
  std::vector<std::string> choices = {};  ///< where a value is one of these, for advice
};

[[nodiscard]] Check Range(double low, double high);
[[nodiscard]] Check IsMember(std::vector<std::string> choices);
extern const Check PositiveNumber, NonNegativeNumber;

/// An option, a flag or a positional argument; lives as long as its program's App. Setters return the option.
class Option {
 public:
  Option* required(bool value = true);
  Option* type_name(const std::string& name);  ///< of its value, for --help and errors: "FILE"
  Option* check(Check check);
  Option* capture_default_str();  ///< shows the variable's value now as default
  Option* expected(int count);
  Option* delimiter(char between);
  Option* allow_extra_args(bool value = true);
  Option* take_all();
  Option* needs(Option* other);             ///< given only beside other
  Option* excludes(Option* other);          ///< given only without other
  [[nodiscard]] std::size_t count() const;  ///< values given

  struct Impl;
  explicit Option(std::unique_ptr<Impl> impl);
  ~Option();
  Option(const Option&) = delete;
  Option& operator=(const Option&) = delete;

 private:
  std::unique_ptr<Impl> impl_;
};

template <class T, class... Types>
concept one_of = (std::same_as<T, Types> || ...);
/// What an option's value can be read into. Numbers are decimal.
template <class T>
concept Value = one_of<T, std::string, std::filesystem::path, int, unsigned, std::int64_t, std::uint64_t,
                       double, std::optional<double>, std::optional<std::uint64_t>, std::vector<std::string>,
                       std::vector<std::filesystem::path>, std::vector<double>>;

/// A program, or one of its subcommands.
class App {
 public:
  explicit App(const std::string& description = "", const std::string& name = "");
  ~App();
  App(App&&) noexcept;

  App* add_subcommand(const std::string& name, const std::string& description = "");
  /// @param names "--output", "-q,--quiet", or "FILE" for an argument told by its place
  template <Value T>
  Option* add_option(const std::string& names, T& value, const std::string& help = "");
  Option* add_flag(const std::string& names, bool& value, const std::string& help = "");
  Option* set_version_flag(const std::string& names, const std::string& version);
  App* callback(std::function<void()> work);  ///< called when the command was given and is complete
  App* footer(std::string text);
  App* footer(std::function<std::string()> text);
  App* require_subcommand(int count);
  App* column_width(std::size_t characters);  ///< of the left column of --help
  [[nodiscard]] bool got_subcommand(const std::string& name) const;

  /// Reads the command line; prints --help and --version. @return the exit status where the program ends here
  /// @throws UsageError in one line for what is wrong, with the nearest name for a slip
  [[nodiscard]] std::optional<int> parse(int argc, const char* const* argv);

  struct Impl;

 private:
  explicit App(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::cli
