#pragma once
// Style sheet and script of the report's page (train/report/page), carried inside the program.

#include <string_view>

namespace elrom::report {

[[nodiscard]] std::string_view page_style();
[[nodiscard]] std::string_view page_script();

}  // namespace elrom::report
