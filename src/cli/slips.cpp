#include "slips.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::cli {

namespace {

using Words = std::vector<std::string>;

/// "-5" is a number, and "-" standard output.
bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word[1] != '.' && (word[1] < '0' || word[1] > '9');
}

/// "--set" of "--set=a=1", "-q" of "-qv"
std::string name_of(const std::string& word) {
  return word.starts_with("--") ? word.substr(0, word.find('=')) : word.substr(0, 2);
}

std::string look_at_help(const ::CLI::App& app) {
  return "'" + full_name(app) + " --help' lists what it takes";
}

std::string without_dashes(const std::string& name) {
  return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

std::vector<std::string> option_names(const ::CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* option : app.get_options())
    for (const auto& name : option->get_lnames()) names.push_back(name);
  return names;
}

std::vector<std::string> command_names(const ::CLI::App& program) {
  std::vector<std::string> names;
  for (const auto* command : program.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

const ::CLI::App* command_called(const ::CLI::App& program, const std::string& name) {
  for (const auto* command : program.get_subcommands({}))
    if (command->get_name() == name) return command;
  return nullptr;
}

// Dashes are no part of the name: "-bundle" is as near to "--bundle" as "--bundel".
std::string option_advice(const ::CLI::App& app, const std::string& name) {
  const auto near = base::closest_name(without_dashes(name), option_names(app));
  return near ? "did you mean --" + *near + "?" : look_at_help(app);
}

[[noreturn]] void refuse_option(const ::CLI::App& program, const ::CLI::App& app, const std::string& word) {
  const auto name = word.starts_with("--") ? name_of(word) : word;
  if (&app == &program)
    for (const auto* command : program.get_subcommands({}))
      if (command->get_option_no_throw(name) != nullptr)
        throw UsageError({.what = "option " + name + " in front of the command",
                          .advice = "write it behind: " + full_name(*command) + " " + name});
  throw UsageError({.what = full_name(app) + " has no option " + name, .advice = option_advice(app, name)});
}

[[noreturn]] void refuse_command(const ::CLI::App& program, const std::string& word) {
  throw UsageError(
      {.what = "unknown command '" + word + "'", .advice = base::name_advice(word, command_names(program))});
}

/// "--output FILE"
std::string form_of(const ::CLI::Option& option) {
  return option.nonpositional()
             ? option.get_name() + " " + option.get_type_name().substr(0, option.get_type_name().find(':'))
             : option.get_name(true);
}

/// The command line of one command, word by word.
class Reader {
 public:
  Reader(const ::CLI::App& program, const Words& words) : program_(program), words_(words) {}

  void read() {
    const ::CLI::App* app = &program_;
    for (; at_ < words_.size() && words_[at_] != "--"; ++at_) {
      if (is_option(words_[at_])) {
        look_at_option(*app);
      } else if (app == &program_ && !command_names(program_).empty()) {
        app = command_called(program_, words_[at_]);
        if (app == nullptr) refuse_command(program_, words_[at_]);
      }
    }
    if (app == &program_ && !command_names(program_).empty())
      throw UsageError(
          {.what = "no command given", .advice = "known are: " + base::join(command_names(program_), ", ")});
  }

 private:
  void look_at_option(const ::CLI::App& app) {
    const auto& word = words_[at_];
    const auto* option = app.get_option_no_throw(name_of(word));
    if (option == nullptr) refuse_option(program_, app, word);
    if (option->get_items_expected_max() == 0) return;
    if (++given_[option] > 1 && option->get_expected_max() == 1)
      throw UsageError({.what = option->get_name() + " is given twice", .expected = "one value"});
    if (word.find('=') != std::string::npos || !word.starts_with("--")) return;
    if (at_ + 1 == words_.size() || is_option(words_[at_ + 1]))
      throw UsageError({.what = option->get_name() + " has no value", .expected = form_of(*option)});
    ++at_;
  }

  const ::CLI::App& program_;
  const Words& words_;
  std::size_t at_ = 0;
  std::map<const ::CLI::Option*, int> given_;
};

bool asks_for_help(const Words& words) {
  for (const auto& word : words) {
    if (word == "--") return false;
    if (word == "--help" || word == "-h" || word == "--version") return true;
  }
  return false;
}

/// The command that was given, or the program.
const ::CLI::App& called(const ::CLI::App& program) {
  const auto commands = program.get_subcommands();
  return commands.empty() ? program : *commands.front();
}

/// The first word for which the command has no place.
std::optional<std::string> word_too_many(const ::CLI::App& app) {
  if (const auto extra = app.remaining(); !extra.empty()) return extra.front();
  for (const auto* option : app.get_options()) {
    const auto most = static_cast<std::size_t>(option->get_items_expected_max());
    if (option->get_positional() && option->count() > most) return option->results()[most];
  }
  return std::nullopt;
}

}  // namespace

std::string full_name(const ::CLI::App& app) {
  return (app.get_parent() != nullptr ? app.get_parent()->get_name() + " " : "") + app.get_name();
}

void look_for_slips(const ::CLI::App& program, const Words& words) {
  if (!asks_for_help(words)) Reader(program, words).read();
}

void refuse(const ::CLI::App& program, const ::CLI::ParseError& error) {
  const auto& app = called(program);
  if (const auto word = word_too_many(app))
    throw UsageError(
        {.what = full_name(app) + " does not take '" + *word + "'", .advice = look_at_help(app)});
  std::vector<std::string> missing;
  for (const auto* option : app.get_options())
    if (option->get_required() && option->count() == 0) missing.push_back(form_of(*option));
  if (!missing.empty())
    throw UsageError(
        {.what = full_name(app) + " needs " + base::join(missing, ", "), .advice = look_at_help(app)});
  throw UsageError({.what = error.what(), .advice = look_at_help(app)});
}

}  // namespace elrom::cli
