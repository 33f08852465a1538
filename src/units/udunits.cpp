#include "elrom/units/udunits.hpp"

#include <udunits2.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <regex>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "spelling.hpp"

namespace elrom::units {

namespace {

using UnitPointer = std::unique_ptr<ut_unit, decltype(&ut_free)>;

/// How SI units are written; of two with one dimension the first is taken. The table's are among them.
constexpr std::array si_units{
    "1",      "kg/s",  "kg",  "m",    "K",    "Pa",        "m/s",      "s",     "m3",       "kg/m3",
    "N/m",    "rad/s", "W",   "rad",  "m2",   "m3/s",      "m2/s",     "m/s2",  "1/s",      "1/m",
    "1/K",    "1/m3",  "N",   "J",    "J/kg", "J/K",       "J/(kg K)", "W/m2",  "W/(m2 K)", "W/(m K)",
    "W/m3",   "K/m",   "K/s", "Pa s", "Pa/m", "kg/(m2 s)", "kg/m2",    "mol",   "mol/s",    "mol/m3",
    "kg/mol", "J/mol", "A",   "V",    "Nm3",  "Nm3/s",     "kg/Nm3",   "J/Nm3", "Nm3/kg"};

class Database {
 public:
  Database() {
    ut_set_error_message_handler(ut_ignore);
    system_ = ut_read_xml(nullptr);
    if (system_ == nullptr)
      throw SystemError(
          "the units of UDUNITS cannot be read; install libudunits2-data, or name its list in UDUNITS2_XML_PATH");
    auto* const normal = ut_new_base_unit(system_);
    ut_map_name_to_unit(normal_cubic_metre, UT_ASCII, normal);
    ut_map_unit_to_symbol(normal, normal_cubic_metre, UT_ASCII);
    ut_free(normal);
    for (const char* si : si_units) si_of_.emplace(product(*parse(udunits_spelling(si))), si);
  }

  [[nodiscard]] std::optional<base::Unit> find(std::string_view symbol) const {
    const auto spelling = udunits_spelling(symbol);
    const auto unit = parse(spelling);
    if (spelling.empty() || !unit) return std::nullopt;
    const auto dimension = product(*unit);
    const auto base = parse(dimension);
    if (!base) return std::nullopt;
    const std::unique_ptr<cv_converter, decltype(&cv_free)> convert(ut_get_converter(unit.get(), base.get()),
                                                                    cv_free);
    if (!convert) return std::nullopt;
    const double offset = cv_convert_double(convert.get(), 0);
    const double factor = cv_convert_double(convert.get(), 1) - offset;
    const bool proportional = std::abs(cv_convert_double(convert.get(), 1000) - offset - 1000 * factor) <=
                              1e-9 * std::abs(1000 * factor) + 1e-12 * std::abs(offset);
    if (!proportional || !std::isfinite(factor) || factor == 0) return std::nullopt;
    const auto si = si_of_.find(dimension);
    return base::Unit{std::string(symbol), si == si_of_.end() ? in_words(dimension) : si->second, factor,
                      offset};
  }

 private:
  [[nodiscard]] UnitPointer parse(const std::string& text) const {
    return {ut_parse(system_, text.c_str(), UT_UTF8), ut_free};
  }

  /// Base units and their powers, "kg.s-3": equal for units of one dimension.
  static std::string product(const ut_unit& unit) {
    std::array<char, 500> text{};
    const int length = ut_format(&unit, text.data(), text.size(), UT_ASCII | UT_DEFINITION);
    if (length < 0 || static_cast<std::size_t>(length) >= text.size()) return {};
    static const std::regex factor(R"(^-?[0-9.]+(e[-+]?\d+)? )"), offset(" @ .*$");
    return std::regex_replace(std::regex_replace(std::string(text.data()), factor, ""), offset, "");
  }

  /// "kg m-1", for a dimension that has no spelling.
  static std::string in_words(const std::string& dimension) {
    static const std::regex dot(R"(\.)"), normal(normal_cubic_metre);
    return std::regex_replace(std::regex_replace(dimension, dot, " "), normal, "Nm3");
  }

  ut_system* system_ = nullptr;  // lives as long as the process
  std::map<std::string, std::string> si_of_;
};

}  // namespace

std::optional<base::Unit> find(std::string_view symbol) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  static const Database database;
  return database.find(symbol);
}

void use_udunits() { base::set_unit_source(find); }

}  // namespace elrom::units
