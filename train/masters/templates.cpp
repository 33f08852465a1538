#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/masters/foreign_program.hpp"

namespace elrom::masters {
namespace {

std::string load_in(const TemplateValues& values, const std::string& where) {
  if (values.load) return base::number(*values.load);
  throw InputError(Problem{.what = "the scenario does not tell its load",
                           .where = where,
                           .advice = "give the scenario its load, or leave {{load}} out of the template"});
}

std::vector<std::string> known_blanks(const TemplateValues& values) {
  auto names = values.schema.names();
  names.insert(names.end(), {"case", "load", "inputs"});
  return names;
}

std::string value_of(const std::string& blank, const TemplateValues& values, const std::string& where) {
  if (blank == "case") return values.case_name;
  if (blank == "load") return load_in(values, where);
  if (blank == "inputs") return values.document;
  const auto [name, symbol] = base::split_unit(blank);
  for (std::size_t i = 0; i < values.schema.size(); ++i) {
    const auto& info = values.schema[i];
    if (info.name != name) continue;
    const auto& unit = base::unit(symbol.empty() ? info.unit : symbol);
    constexpr int digits = 12;  // of 15: a conversion's last ones are noise
    if (unit.si == info.unit) return base::rounded(unit.from_si(values.inputs[i]), digits);
    throw InputError(Problem{.what = "unit of another dimension for '" + name + "'",
                             .where = where,
                             .found = symbol,
                             .expected = info.unit});
  }
  throw InputError(Problem{.what = "unknown blank '" + blank + "'",
                           .where = where,
                           .advice = base::name_advice(name, known_blanks(values))});
}

}  // namespace

std::string fill_blanks(const std::string& text, const TemplateValues& values, const std::string& where) {
  std::string result;
  std::size_t at = 0;
  for (;;) {
    const auto open = text.find("{{", at), close = text.find("}}", open);
    if (close == std::string::npos) return result + text.substr(at);
    result += text.substr(at, open - at);
    result += value_of(base::trim(text.substr(open + 2, close - open - 2)), values, where);
    at = close + 2;
  }
}

void fill_templates(const std::filesystem::path& from, const std::filesystem::path& to,
                    const TemplateValues& values) {
  std::filesystem::create_directories(to);
  std::filesystem::copy(from, to, std::filesystem::copy_options::recursive);
  std::vector<std::filesystem::path> blank;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(to))
    if (entry.is_regular_file() && entry.path().extension() == ".in") blank.push_back(entry.path());
  for (const auto& file : blank) {
    auto target = file;
    target.replace_extension();
    base::write_text(target,
                     fill_blanks(base::read_text(file), values, file.lexically_relative(to).string()));
    std::filesystem::permissions(target, std::filesystem::status(file).permissions());
    std::filesystem::remove(file);
  }
}

}  // namespace elrom::masters
