// Collision models in words, as a table for the terminal and as JSON. NaN has no JSON form: it becomes null.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "collisions_words.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"
#include "json_number.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

std::string range(const particle::Range& range, double factor, const char* unit) {
  const auto low = base::rounded(range.low * factor), high = base::rounded(range.high * factor);
  return (low == high ? low : low + " to " + high) + " " + unit;
}

const CollisionModelReport& nearest(const CollisionReport& report) {
  return *std::min_element(report.models.begin(), report.models.end(), [](const auto& a, const auto& b) {
    return a.errors.mae_velocity < b.errors.mae_velocity;
  });
}

// Two digits: "3.6", "3900".
std::string ratio_text(double ratio) {
  if (!(ratio >= 100 && ratio < 1e15)) return base::rounded(ratio, 2);
  const double unit = std::pow(10.0, std::floor(std::log10(ratio)) - 1);
  return fmt::format("{:.0f}", unit * std::round(ratio / unit));
}

std::string balance_words(const particle::CollisionErrors& errors) {
  return fmt::format("{} and {}",
                     errors.momentum_error < 1e-12 ? "keeps momentum to rounding"
                                                   : fmt::format("changes a pair's momentum by {} on average",
                                                                 percent_text(errors.mean_momentum_error, 2)),
                     errors.gaining_share == 0
                         ? "gives no pair energy"
                         : "gives " + percent_text(errors.gaining_share) + " of the pairs energy");
}

Json json_of(const CollisionModelReport& model) {
  Json node{{"name", model.name},
            {"file", model.file.filename().string()},
            {"surrogate", particle::surrogate_names.name(model.kind)},
            {"mae", model.errors.mae},
            {"mae_velocity", number(model.errors.mae_velocity)},
            {"momentum_error", number(model.errors.momentum_error)},
            {"energy_gain", number(model.errors.energy_gain)},
            {"training_s", number(model.training_seconds)},
            {"calls_per_second", number(1 / model.call_seconds)},
            {"front", model.front},
            {"learned_from_this_set", model.learned_from_set},
            {"differs", model.differs}};
  node["errors"] = Json::parse(particle::to_json(model.errors));
  node["mae_by_angle"] = numbers(model.figures.by_angle);
  node["mae_by_speed"] = numbers(model.figures.by_speed);
  return node;
}

}  // namespace

std::string speed_text(double metres_per_second) { return base::rounded(metres_per_second, 3) + " m/s"; }

std::string call_text(double seconds) {
  return seconds < 1e-6 ? base::rounded(seconds * 1e9, 3) + " ns" : base::rounded(seconds * 1e6, 3) + " us";
}

std::string mark_text(const CollisionReport& report, const CollisionModelReport& model) {
  if (!model.differs.empty()) return "learned for other " + base::join(model.differs, ", ");
  if (!model.learned_from_set && model.kind != particle::SurrogateKind::exact)
    return "learned from another file of the same protocol; with the same seed, these pairs are not new to it";
  return report.judges_all() ? "" : "these pairs were not learned from";
}

std::string headline(const CollisionReport& report) {
  const auto& best = nearest(report);
  auto text =
      fmt::format("{} errs by {} on average in the velocity components of {} pairs{}, {}.", best.name,
                  speed_text(best.errors.mae_velocity), report.n_judged,
                  report.judges_all() ? "" : " that no model learned from", balance_words(best.errors));
  const auto document =
      std::find_if(report.models.begin(), report.models.end(), [&](const CollisionModelReport& model) {
        return model.kind == particle::SurrogateKind::document && &model != &best;
      });
  if (document != report.models.end())
    text += fmt::format(" The source's kind, {}, errs by {}, {}.", document->name,
                        speed_text(document->errors.mae_velocity), balance_words(document->errors));
  for (const auto& model : report.models)
    if (!model.differs.empty())
      text += fmt::format(" Misleading: {} was learned for other {}.", model.name,
                          base::join(model.differs, ", "));
  return text;
}

std::string cost_sentence(const CollisionReport& report) {
  std::vector<const CollisionModelReport*> front;
  for (const auto& model : report.models)
    if (model.front) front.push_back(&model);
  if (front.empty()) return "No model gave numbers.";
  const auto by_time = [](const auto* a, const auto* b) { return a->call_seconds < b->call_seconds; };
  const auto& fast = **std::min_element(front.begin(), front.end(), by_time);
  const auto& near = **std::max_element(front.begin(), front.end(), by_time);
  const auto trained = [](const CollisionModelReport& model) {
    if (!model.training_seconds) return std::string("training not kept");
    return *model.training_seconds < 1e-3 ? std::string("no training")
                                          : base::duration(*model.training_seconds) + " of training";
  };
  if (&fast == &near)
    return fmt::format(
        "Accuracy costs nothing here: {} is both the nearest ({}) and the fastest ({} a call, {}).",
        near.name, speed_text(near.errors.mae_velocity), call_text(near.call_seconds), trained(near));
  return fmt::format(
      "{} times less error costs {} times the time of a call: {} errs by {} at {} a call ({}), {} by {} at {} "
      "({}).",
      ratio_text(fast.errors.mae_velocity / near.errors.mae_velocity),
      ratio_text(near.call_seconds / fast.call_seconds), near.name, speed_text(near.errors.mae_velocity),
      call_text(near.call_seconds), trained(near), fast.name, speed_text(fast.errors.mae_velocity),
      call_text(fast.call_seconds), trained(fast));
}

std::vector<std::string> set_sentences(const CollisionReport& report) {
  const auto& protocol = report.protocol;
  const auto& summary = report.summary;
  const auto share = [&](std::size_t n) {
    return percent_text(static_cast<double>(n) / static_cast<double>(summary.n_pairs));
  };
  std::vector<std::string> sentences;
  sentences.push_back(fmt::format("{} collisions of two spheres, protocol {}, seed {}; contact law {}.",
                                  summary.n_pairs, particle::protocol_names.name(protocol.kind), report.seed,
                                  report.law.text()));
  sentences.push_back(fmt::format(
      "Speeds {}, diameters {} and {}, densities {} and {} kg/m3, {}.", range(protocol.speed, 1, "m/s"),
      range(protocol.diameter_1, 1e6, "um"), range(protocol.diameter_2, 1e6, "um"),
      base::rounded(protocol.density_1), base::rounded(protocol.density_2),
      protocol.spin_speed > 0 ? "surfaces spin at up to " + speed_text(protocol.spin_speed)
                              : std::string("no spins")));
  sentences.push_back(
      fmt::format("{} head-on, {} crossing, {} catching up, {} grazing; {} of the kinetic energy is "
                  "lost.",
                  share(summary.head_on), share(summary.crossing), share(summary.catching_up),
                  share(summary.grazing), percent_text(summary.energy_lost, 2)));
  if (summary.started_overlapped > 0)
    sentences.push_back(
        fmt::format("{} of the pairs start overlapped: what comes out of those is no collision of "
                    "two spheres.",
                    share(summary.started_overlapped)));
  if (report.speed_cap)
    sentences.push_back(fmt::format("Velocities after the contact are cut to {}; {} pairs were.",
                                    speed_text(*report.speed_cap), summary.capped));
  sentences.push_back(
      report.judges_all()
          ? "No model here learned from this file, so all of its pairs judge."
          : fmt::format("Its last {} pairs judge; models learned from the others.", report.n_judged));
  return sentences;
}

std::string terminal_table(const CollisionReport& report) {
  std::size_t width = 12;
  for (const auto& model : report.models) width = std::max(width, model.name.size());
  auto text = "\n  " + base::join(set_sentences(report), "\n  ") + "\n\n";
  text += fmt::format("  {:<{}}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}  {:>10}\n", "MAE [m/s]", width, "u",
                      "v", "w", "momentum", "gains", "a call", "training");
  for (const auto& model : report.models) {
    const auto& errors = model.errors;
    text += fmt::format("  {:<{}}  {:>9}  {:>9}  {:>9}  {:>9.2g}  {:>9}  {:>9}  {:>10}{}\n", model.name,
                        width, base::rounded(errors.mae[0], 3), base::rounded(errors.mae[1], 3),
                        base::rounded(errors.mae[2], 3), errors.momentum_error,
                        percent_text(errors.gaining_share), call_text(model.call_seconds),
                        model.training_seconds ? base::duration(*model.training_seconds) : "not kept",
                        model.differs.empty() ? "" : "  ! other " + base::join(model.differs, ", "));
  }
  return text + "\n  " + headline(report) + "\n  " + cost_sentence(report) + "\n";
}

std::string to_json(const CollisionReport& report) {
  auto root = io::json_head<Json>(io::kinds::collision_report);
  root["headline"] = headline(report);
  root["cost"] = cost_sentence(report);
  root["set"] = {{"file", report.set.filename().string()},
                 {"sha256", report.digest},
                 {"pairs", report.summary.n_pairs},
                 {"protocol", particle::protocol_names.name(report.protocol.kind)},
                 {"law", report.law.text()},
                 {"seed", report.seed},
                 {"speed_cap_m_per_s", number(report.speed_cap)},
                 {"started_overlapped", report.summary.started_overlapped},
                 {"capped", report.summary.capped}};
  root["judged_pairs"] = report.n_judged;
  root["angle_edges_degrees"] = numbers(report.angle_edges);
  root["speed_edges_m_per_s"] = numbers(report.speed_edges);
  root["source"] = Json::array();
  for (const auto& printed : source_mae)
    root["source"].push_back({{"diameter_m", printed.diameter}, {"mae", printed.mae}});
  root["models"] = Json::array();
  for (const auto& model : report.models) root["models"].push_back(json_of(model));
  return root.dump(1) + '\n';
}

}  // namespace elrom::report
