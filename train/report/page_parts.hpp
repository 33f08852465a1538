#pragma once
// Sections of the page; each returns HTML. Internal to page*.cpp.

#include <string>
#include <string_view>

#include "elrom/report/page.hpp"
#include "svg.hpp"

namespace elrom::report {

/// Series class of a method, the same in every table and drawing: "s0" is the study's model.
[[nodiscard]] std::string series_class(const AccuracyReport& report, std::size_t method);
/// <ul> of line samples for methods, the truth first where asked.
[[nodiscard]] std::string method_legend(const AccuracyReport& report, bool with_truth);
[[nodiscard]] std::string section(std::string_view id, std::string_view title, std::string_view lead,
                                  std::string_view body);

[[nodiscard]] std::string figure(const std::string& caption, const std::string& drawing);
/// A page that opens offline around these links and the content of <main>.
[[nodiscard]] std::string whole_page(const std::string& title, const std::string& links,
                                     const std::string& content);
/// Truth to the right, prediction upwards; darker: more. The axes are the map's, in the unit that is shown.
[[nodiscard]] std::string parity_drawing(const ParityMap& map, const svg::Axis& x, const svg::Axis& y,
                                         const std::string& css_class, const std::string& title);

[[nodiscard]] std::string key_figures(const AccuracyReport& report);
[[nodiscard]] std::string score_tables(const AccuracyReport& report);
/// What cross-validation on the training cases found; empty when no field chose among candidates.
[[nodiscard]] std::string choice_section(const AccuracyReport& report);
[[nodiscard]] std::string worst_cell_table(const AccuracyReport& report);
[[nodiscard]] std::string submodel_table(const AccuracyReport& report);
[[nodiscard]] std::string validity_table(const AccuracyReport& report);
[[nodiscard]] std::string audit_table(const AccuracyReport& report);
[[nodiscard]] std::string provenance(const AccuracyReport& report);

[[nodiscard]] std::string load_section(const AccuracyReport& report);
[[nodiscard]] std::string budget_section(const AccuracyReport& report);
[[nodiscard]] std::string coverage_section(const AccuracyReport& report);
[[nodiscard]] std::string error_section(const AccuracyReport& report);
[[nodiscard]] std::string profile_section(const AccuracyReport& report);
[[nodiscard]] std::string search_section(const std::vector<networks::TrialStore::Search>& searches);
[[nodiscard]] std::string learning_section(const LearningCurve& curve);
[[nodiscard]] std::string cost_section(const CostReport& cost);

/// One drawing of the viewer of cuts.
struct CutPanel {
  std::string title;
  /// A series of the data: "0" is the truth, "1" the first method, "chosen" the one that the viewer's select
  /// names; or the difference of two: "chosen-0"
  std::string series;
};
/// The viewer of cuts and its embedded data. @param panels three to a row
[[nodiscard]] std::string cut_viewer(const AccuracyReport& report, const std::vector<CutPanel>& panels,
                                     bool with_choice);
[[nodiscard]] std::string cut_section(const AccuracyReport& report);

}  // namespace elrom::report
