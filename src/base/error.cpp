#include "elrom/base/error.hpp"

#include <algorithm>

namespace elrom {
namespace {

/// What a file holds may be of any length and hold anything: a message shows its beginning, in one line and
/// without what would move a terminal's cursor.
std::string excerpt(std::string_view text) {
  constexpr std::size_t most = 300;
  std::string shown(text.substr(0, most));
  if (text.size() > most) {
    // Not in the middle of a UTF-8 character.
    while (!shown.empty() && (static_cast<unsigned char>(text[shown.size()]) & 0xC0U) == 0x80U)
      shown.pop_back();
    shown += "... (" + std::to_string(text.size()) + " bytes)";
  }
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
  return shown;
}

}  // namespace

std::string Problem::message() const {
  std::string text = what;
  if (!where.empty()) text += " in " + where;
  if (!found.empty()) text += ": found " + excerpt(found);
  if (!expected.empty()) text += (found.empty() ? ": expected " : ", expected ") + expected;
  if (!advice.empty()) text += "; " + advice;
  return text;
}

void check(bool condition, std::string_view what, const char* file, int line) {
  if (condition) return;
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) + ": " + std::string(what));
}

}  // namespace elrom
