// The learning curve as JSON and as tables for a terminal.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/report/learning_curve.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

using Json = nlohmann::ordered_json;

Json to_node(const LearningPoint& point) {
  return {{"cases", point.cases},
          {"error_mean", point.error_mean},
          {"error_std", point.error_std},
          {"field_error", point.field_error}};
}

LearningPoint to_point(const Json& node) {
  return {.cases = node.at("cases"),
          .error_mean = node.at("error_mean"),
          .error_std = node.at("error_std"),
          .field_error = node.at("field_error").get<std::map<std::string, double>>()};
}

}  // namespace

std::string to_json(const LearningCurve& curve) {
  auto root = io::json_head<Json>(io::kinds::learning_curve);
  root.update({{"study", curve.study},
               {"method", curve.method},
               {"points", Json::array()},
               {"fit",
                {{"floor", curve.fit.floor},
                 {"scale", curve.fit.scale},
                 {"rate", curve.fit.rate},
                 {"at_bound", curve.fit.at_bound()}}},
               {"gain_next_20", std::isfinite(curve.gain_next_20) ? Json(curve.gain_next_20) : Json()},
               {"small", curve.small},
               {"v1", to_node(curve.v1)},
               {"v2", to_node(curve.v2)}});
  for (const auto& point : curve.points) root["points"].push_back(to_node(point));
  return root.dump(1) + '\n';
}

LearningCurve read_learning_curve(const std::filesystem::path& path) {
  const auto root = Json::parse(base::read_text(path), nullptr, false);
  io::check_json_kind(root, io::kinds::learning_curve, path.string());
  try {
    LearningCurve curve{.study = root.at("study"), .method = root.at("method")};
    for (const auto& node : root.at("points")) curve.points.push_back(to_point(node));
    const auto& fit = root.at("fit");
    curve.fit = {fit.at("floor"), fit.at("scale"), fit.at("rate")};
    curve.small = root.value("small", false);
    curve.v1 = to_point(root.at("v1"));
    curve.v2 = to_point(root.at("v2"));
    const auto& gain = root.at("gain_next_20");  // files before 1.1 have one from fits at their bound too
    curve.gain_next_20 = curve.fit.at_bound() || gain.is_null() ? std::nan("") : gain.get<double>();
    if (curve.points.empty())
      throw InputError({.what = "a learning curve without points", .where = path.string()});
    return curve;
  } catch (const Json::exception& fault) {
    throw InputError({.what = "not a learning curve", .where = path.string(), .found = fault.what()});
  }
}

std::string terminal_table(const LearningCurve& curve) {
  auto text =
      fmt::format("\n  Learning curve of {} ({})\n\n  {:>8}  {:>10}  {:>8}  {:>8}\n  {}\n", curve.study,
                  method_label(curve.method), "cases", "mean NRMSE", "+-", "fitted", std::string(40, '-'));
  for (const auto& point : curve.points)
    text += fmt::format("  {:>8}  {:>10}  {:>8}  {:>8}\n", point.cases, score_text(point.error_mean, 4),
                        score_text(point.error_std, 4),
                        score_text(curve.fit.at(static_cast<double>(point.cases)), 4));
  return text + "\n  " + outlook(curve) + "\n";
}

std::string outlook(const LearningCurve& curve) {
  const std::string quick = curve.small ? " A quick look: few sizes, one draw." : "";
  if (!curve.fit.at_bound())
    return fmt::format("20 more cases are expected to lower the error by {}.",
                       percent_text(curve.gain_next_20)) +
           quick;
  std::string why = "The points fall as no power law with an error above zero does";
  if (curve.fit.scale == 0) why = "The error does not fall with the number of cases here";
  return why + ": what more cases would buy cannot be told from them." + quick;
}

std::string v1_v2_table(const LearningCurve& curve) {
  auto text = fmt::format(
      "\n  v1 ({} cases) against v2 ({} cases), {}, the same held-out cases\n\n  {:<24}{:>10}{:>10}{:>10}\n  "
      "{}\n",
      curve.v1.cases, curve.v2.cases, method_label(curve.method), "field", "v1", "v2", "change",
      std::string(54, '-'));
  const auto row = [](const std::string& name, double v1, double v2) {
    return fmt::format("  {:<24}{:>10}{:>10}{:>8.1f} %\n", name, score_text(v1, 4), score_text(v2, 4),
                       100 * (v2 / v1 - 1));
  };
  for (const auto& field : in_usual_order(curve.v2.field_error))
    text += row(field_label(field), curve.v1.field_error.at(field), curve.v2.field_error.at(field));
  return text + "  " + std::string(54, '-') + '\n' + row("mean", curve.v1.error_mean, curve.v2.error_mean);
}

}  // namespace elrom::report
