#include "elrom/cli/cli.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "slips.hpp"

namespace elrom::cli {

struct Option::Impl {
  ::CLI::Option* option;
};

struct App::Impl {
  std::unique_ptr<::CLI::App> own;  ///< null for a subcommand, which its program owns
  ::CLI::App* app;
  std::deque<Option> options;
  std::deque<App> commands;

  Option* add(::CLI::Option* option) {
    return &options.emplace_back(std::make_unique<Option::Impl>(Option::Impl{option}));
  }
};

namespace {

using Results = ::CLI::results_t;

[[noreturn]] void refuse_value(const ::CLI::Option& option, const std::string& value,
                               const std::string& expected, const std::string& advice = "") {
  const bool named = option.nonpositional();
  throw UsageError(
      {.what = option.get_name(!named), .found = "'" + value + "'", .expected = expected, .advice = advice});
}

void read(const ::CLI::Option&, const std::string& text, std::string& value) { value = text; }
void read(const ::CLI::Option&, const std::string& text, std::filesystem::path& value) { value = text; }
void read(const ::CLI::Option& option, const std::string& text, double& value) {
  const auto number = base::to_double(text);
  if (!number) refuse_value(option, text, "a number");
  value = *number;
}
template <std::integral T>
void read(const ::CLI::Option& option, const std::string& text, T& value) {
  const auto* const end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  if (fault != std::errc{} || stop != end)
    refuse_value(option, text, std::unsigned_integral<T> ? "a whole number of at least 0" : "a whole number");
}
template <class T>
void read(const ::CLI::Option& option, const std::string& text, std::optional<T>& value) {
  read(option, text, value.emplace());
}

template <class T>
void read_all(const ::CLI::Option& option, const Results& results, T& value) {
  read(option, results.front(), value);
}
template <class T>
void read_all(const ::CLI::Option& option, const Results& results, std::vector<T>& values) {
  values.clear();
  for (const auto& text : results) read(option, text, values.emplace_back());
}

std::string shown(const std::string& value) { return value; }
std::string shown(const std::filesystem::path& value) { return value.string(); }
std::string shown(double value) { return base::number(value); }
template <std::integral T>
std::string shown(T value) {
  return std::to_string(value);
}
template <class T>
std::string shown(const std::optional<T>& value) {
  return value ? shown(*value) : "";
}
template <class T>
std::string shown(const std::vector<T>& values) {
  std::vector<std::string> texts;
  for (const auto& value : values) texts.push_back(shown(value));
  return base::join(texts, ",");
}

template <class T>
constexpr bool is_list = false;
template <class T>
constexpr bool is_list<std::vector<T>> = true;

template <class T>
const char* kind_of() {
  if (one_of<T, double, std::optional<double>, std::vector<double>>) return "FLOAT";
  if (std::is_same_v<T, std::optional<std::uint64_t>>) return "UINT";
  if (std::is_integral_v<T>) return std::is_signed_v<T> ? "INT" : "UINT";
  return "TEXT";
}

bool is_number(const std::string& text, double low, double high) {
  const auto number = base::to_double(text);
  return number && *number >= low && *number <= high;
}

}  // namespace

Check Range(double low, double high) {
  const auto words = base::number(low) + " to " + base::number(high);
  return {.shown = words, .expected = "a number from " + words, .holds = [=](const std::string& text) {
            return is_number(text, low, high);
          }};
}

Check IsMember(std::vector<std::string> choices) {
  return {.shown = "{" + base::join(choices, ",") + "}",
          .expected = "one of " + base::join(choices, ", "),
          .holds = [=](const std::string& text) { return std::ranges::find(choices, text) != choices.end(); },
          .choices = choices};
}

const Check PositiveNumber{
    .shown = "POSITIVE", .expected = "a number above 0", .holds = [](const std::string& text) {
      return is_number(text, std::numeric_limits<double>::min(), HUGE_VAL);
    }};
const Check NonNegativeNumber{.shown = "NONNEGATIVE",
                              .expected = "a number of at least 0",
                              .holds = [](const std::string& text) { return is_number(text, 0, HUGE_VAL); }};

Option::Option(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Option::~Option() = default;

Option* Option::required(bool value) {
  impl_->option->required(value);
  return this;
}
Option* Option::type_name(const std::string& name) {
  impl_->option->type_name(name);
  return this;
}
Option* Option::check(Check check) {
  const auto* option = impl_->option;
  const auto shown = check.shown;
  impl_->option->check(::CLI::Validator(
      [option, check = std::move(check)](std::string& text) {
        if (!check.holds(text)) {
          const auto near = base::closest_name(text, check.choices);
          refuse_value(*option, text, check.expected, near ? "did you mean " + *near + "?" : "");
        }
        return std::string();
      },
      shown));
  return this;
}
Option* Option::capture_default_str() {
  impl_->option->capture_default_str();
  return this;
}
Option* Option::expected(int count) {
  impl_->option->expected(count);
  return this;
}
Option* Option::delimiter(char between) {
  impl_->option->delimiter(between);
  return this;
}
Option* Option::allow_extra_args(bool value) {
  impl_->option->allow_extra_args(value);
  return this;
}
Option* Option::take_all() {
  impl_->option->take_all();
  return this;
}
Option* Option::needs(Option* other) {
  impl_->option->needs(other->impl_->option);
  return this;
}
Option* Option::excludes(Option* other) {
  impl_->option->excludes(other->impl_->option);
  return this;
}
std::size_t Option::count() const { return impl_->option->count(); }

App::App(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
App::App(const std::string& description, const std::string& name)
    : App(std::make_unique<Impl>(std::make_unique<::CLI::App>(description, name), nullptr)) {
  impl_->app = impl_->own.get();
}
App::App(App&&) noexcept = default;
App::~App() = default;

App* App::add_subcommand(const std::string& name, const std::string& description) {
  auto* command = impl_->app->add_subcommand(name, description);
  impl_->commands.push_back(App(std::make_unique<Impl>(nullptr, command)));
  return &impl_->commands.back();
}

template <Value T>
Option* App::add_option(const std::string& names, T& value, const std::string& help) {
  const auto option =
      std::make_shared<::CLI::Option*>();  // known to its own callback, which is made before it
  *option = impl_->app->add_option(
      names,
      [&value, option](const Results& results) {
        read_all(**option, results, value);
        return true;
      },
      help, false, [&value] { return shown(value); });
  (*option)->type_name(kind_of<T>());
  if (is_list<T>) (*option)->expected(::CLI::detail::expected_max_vector_size);
  return impl_->add(*option);
}

#define ELROM_OPTION(...) \
  template Option* App::add_option(const std::string&, __VA_ARGS__&, const std::string&)
ELROM_OPTION(std::string);
ELROM_OPTION(std::filesystem::path);
ELROM_OPTION(int);
ELROM_OPTION(unsigned);
ELROM_OPTION(std::int64_t);
ELROM_OPTION(std::uint64_t);
ELROM_OPTION(double);
ELROM_OPTION(std::optional<double>);
ELROM_OPTION(std::optional<std::uint64_t>);
ELROM_OPTION(std::vector<std::string>);
ELROM_OPTION(std::vector<double>);
ELROM_OPTION(std::vector<std::filesystem::path>);
#undef ELROM_OPTION

Option* App::add_flag(const std::string& names, bool& value, const std::string& help) {
  return impl_->add(impl_->app->add_flag(names, value, help));
}
Option* App::set_version_flag(const std::string& names, const std::string& version) {
  return impl_->add(impl_->app->set_version_flag(names, version));
}
App* App::callback(std::function<void()> work) {
  impl_->app->callback(std::move(work));
  return this;
}
App* App::footer(std::string text) {
  impl_->app->footer(std::move(text));
  return this;
}
App* App::footer(std::function<std::string()> text) {
  impl_->app->footer(std::move(text));
  return this;
}
App* App::require_subcommand(int count) {
  impl_->app->require_subcommand(count);
  return this;
}
App* App::column_width(std::size_t characters) {
  impl_->app->get_formatter()->column_width(characters);
  return this;
}
bool App::got_subcommand(const std::string& name) const { return impl_->app->got_subcommand(name); }

std::optional<int> App::parse(int argc, const char* const* argv) {
  auto& app = *impl_->app;
  if (app.get_name().empty()) app.name(std::filesystem::path(argv[0]).filename().string());
  look_for_slips(app, std::vector<std::string>(argv + 1, argv + argc));
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const ::CLI::Success& success) {
    return app.exit(success);
  } catch (const ::CLI::ParseError& error) {
    refuse(app, error);
  }
}

}  // namespace elrom::cli
