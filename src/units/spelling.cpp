#include "spelling.hpp"

#include <array>
#include <regex>
#include <utility>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::units {

namespace {

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

// Superscripts and the raised dot are one letter to a reader, and several bytes here.
std::string in_ascii(std::string text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> letters{{{"\u207b", "-"},
                                                                                  {"\u00b9", "1"},
                                                                                  {"\u00b2", "2"},
                                                                                  {"\u00b3", "3"},
                                                                                  {"\u00b7", "."},
                                                                                  {"\u00b5", "u"},
                                                                                  {"\u03bc", "u"},
                                                                                  {"\u00b0C", "degC"}}};
  for (const auto& [letter, ascii] : letters) text = replaced(std::move(text), letter, ascii);
  return text;
}

// Products written in one word, of units that nobody takes for a prefix: kgK, Pas, kWh. "barg" stays unknown.
std::string unglued(const std::string& text) {
  static const std::regex word(R"(\b(kg|g|N|kN|W|kW|MW|GW|TW|Pa|mPa|kPa|J|kJ|mol|kmol)(K|s|h|m)\b)");
  static const std::regex behind_exponent(R"(([A-Za-z]\^?\d)([A-Za-z]))");
  return std::regex_replace(std::regex_replace(text, behind_exponent, "$1 $2"), word, "$1 $2");
}

// What is glued behind a slash is all of it below the line.
std::string glued_denominators(const std::string& text) {
  static const std::regex denominator(R"(/\s*([A-Za-z][A-Za-z0-9^]*))");
  std::string result;
  auto from = text.cbegin();
  for (std::sregex_iterator at(text.begin(), text.end(), denominator), end; at != end; ++at) {
    const auto parts = unglued((*at)[1].str());
    result.append(from, (*at)[0].first);
    result += parts.find(' ') == std::string::npos ? (*at)[0].str() : "/(" + parts + ")";
    from = (*at)[0].second;
  }
  return result.append(from, text.cend());
}

void refuse_two_readings(const std::string& text) {
  static const std::regex two(R"(^(.*?)/\s*([^\s./*()]+)\s*[\s.*]\s*([A-Za-z(][^/]*)$)");
  std::smatch part;
  if (!std::regex_match(text, part, two)) return;
  const auto above = base::trim(part[1].str()), below = part[2].str(), last = base::trim(part[3].str());
  throw InputError(
      {.what = "unit '" + text + "' can be read in two ways",
       .expected = above + "/(" + below + " " + last + "), or " + above + " " + last + "/" + below});
}

std::string named(std::string text) {
  static const std::regex normal(R"(\bNm\^?3(?!\d))"), degree(R"(\bdeg\b)");
  return std::regex_replace(std::regex_replace(text, normal, normal_cubic_metre), degree, "degree");
}

}  // namespace

std::string udunits_spelling(std::string_view symbol) {
  const auto text = named(in_ascii(base::trim(symbol)));
  refuse_two_readings(text);
  return unglued(glued_denominators(text));
}

}  // namespace elrom::units
