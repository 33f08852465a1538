// The learning curve as JSON and as tables for a terminal.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/report/learning_curve.hpp"
#include "json_number.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

double number_of(const Json& node, const char* key) {
  return node.contains(key) && node[key].is_number() ? node[key].get<double>() : undefined;
}

Json to_node(const LearningPoint& point) {
  return {{"cases", point.cases},
          {"error_mean", point.error_mean},
          {"error_std", point.error_std},
          {"field_error", point.field_error},
          {"averaged_mean", number(point.averaged_mean)},
          {"averaged_std", number(point.averaged_std)}};
}

LearningPoint to_point(const Json& node) {
  return {.cases = node.at("cases"),
          .error_mean = node.at("error_mean"),
          .error_std = node.at("error_std"),
          .field_error = node.at("field_error").get<std::map<std::string, double>>(),
          .averaged_mean = number_of(node, "averaged_mean"),
          .averaged_std = number_of(node, "averaged_std")};
}

Json to_node(const PowerLaw& fit) {
  return {{"floor", fit.floor}, {"scale", fit.scale}, {"rate", fit.rate}, {"at_bound", fit.at_bound()}};
}
PowerLaw to_law(const Json& node) { return {node.at("floor"), node.at("scale"), node.at("rate")}; }

Json to_node(const AveragingCurve& curve) {
  Json node{{"levels", Json::array()}, {"fields", Json::object()}};
  for (const auto& level : curve.levels)
    node["levels"].push_back({{"noise", level.noise}, {"error_mean", level.error_mean}});
  for (const auto& [name, field] : curve.fields)
    node["fields"][name] = {{"clean", field.clean}, {"noise", field.noise}};
  return node;
}
AveragingCurve to_averaging(const Json& node) {
  AveragingCurve curve;
  for (const auto& level : node.at("levels"))
    curve.levels.push_back({level.at("noise"), level.at("error_mean")});
  for (const auto& [name, field] : node.at("fields").items())
    curve.fields[name] = {field.at("clean"), field.at("noise")};
  return curve;
}

}  // namespace

std::string to_json(const LearningCurve& curve) {
  auto root = io::json_head<Json>(io::kinds::learning_curve);
  root.update(
      {{"study", curve.study},
       {"method", curve.method},
       {"points", Json::array()},
       {"fit", to_node(curve.fit)},
       {"gain_next_20", number(curve.gain_next_20)},
       {"small", curve.small},
       {"v1", to_node(curve.v1)},
       {"v2", to_node(curve.v2)},
       {"averaged_fit", to_node(curve.averaged_fit)},
       {"averaging", to_node(curve.averaging)},
       {"price",
        {{"name", curve.price.name}, {"hours", curve.price.hours}, {"start_up", curve.price.start_up}}}});
  for (const auto& point : curve.points) root["points"].push_back(to_node(point));
  return root.dump(1) + '\n';
}

LearningCurve read_learning_curve(const std::filesystem::path& path) {
  const auto root = Json::parse(base::read_text(path), nullptr, false);
  io::check_json_kind(root, io::kinds::learning_curve, path.string());
  try {
    LearningCurve curve{.study = root.at("study"), .method = root.at("method")};
    for (const auto& node : root.at("points")) curve.points.push_back(to_point(node));
    curve.fit = to_law(root.at("fit"));
    curve.small = root.value("small", false);
    curve.v1 = to_point(root.at("v1"));
    curve.v2 = to_point(root.at("v2"));
    if (root.contains("averaging")) {  // since 1.2
      curve.averaged_fit = to_law(root.at("averaged_fit"));
      curve.averaging = to_averaging(root.at("averaging"));
      const auto& price = root.at("price");
      curve.price = {price.at("name"), price.at("hours"), price.at("start_up")};
    }
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
  const bool averaged = curve.has_averaged_truth();
  auto text = fmt::format("\n  Learning curve of {} ({})\n\n  {:>8}  {:>10}  {:>8}  {:>8}{}\n  {}\n",
                          curve.study, method_label(curve.method), "cases", "mean NRMSE", "+-", "fitted",
                          averaged ? "   averaged truths      +-    fitted" : "",
                          std::string(averaged ? 75 : 40, '-'));
  for (const auto& point : curve.points) {
    const auto n = static_cast<double>(point.cases);
    text += fmt::format("  {:>8}  {:>10}  {:>8}  {:>8}", point.cases, score_text(point.error_mean, 4),
                        score_text(point.error_std, 4), score_text(curve.fit.at(n), 4));
    if (averaged)
      text += fmt::format("  {:>16}  {:>6}  {:>8}", score_text(point.averaged_mean, 4),
                          score_text(point.averaged_std, 4), score_text(curve.averaged_fit.at(n), 4));
    text += '\n';
  }
  return text + "\n  " + outlook(curve) + "\n";
}

namespace {

std::string averaged_outlook(const LearningCurve& curve) {
  if (!curve.has_averaged_truth() || curve.averaged_fit.at_bound()) return "";
  const auto n = static_cast<double>(curve.v2.cases);
  return fmt::format(", against averaged truths by {}",
                     percent_text(1 - curve.averaged_fit.at(n + 20) / curve.averaged_fit.at(n)));
}

}  // namespace

std::string outlook(const LearningCurve& curve) {
  const std::string quick = curve.small ? " A quick look: few sizes, one draw." : "";
  if (!curve.fit.at_bound())
    return fmt::format("20 more cases are expected to lower the error by {}{}.",
                       percent_text(curve.gain_next_20), averaged_outlook(curve)) +
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
