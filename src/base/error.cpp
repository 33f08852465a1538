#include "elrom/base/error.hpp"

namespace elrom {

std::string Problem::message() const {
  std::string text = what;
  if (!where.empty()) text += " in " + where;
  if (!found.empty()) text += ": found " + found;
  if (!expected.empty()) text += (found.empty() ? ": expected " : ", expected ") + expected;
  if (!advice.empty()) text += "; " + advice;
  return text;
}

void check(bool condition, std::string_view what, const char* file, int line) {
  if (condition) return;
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) + ": " + std::string(what));
}

}  // namespace elrom
