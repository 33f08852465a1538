#include "collision_words.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/particle/collision_summary.hpp"

namespace elrom::programs {

namespace {

using Json = nlohmann::ordered_json;
using particle::CollisionSummary;

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json json_of(const particle::Spread& spread) {
  if (std::isnan(spread.mean)) return {{"min", nullptr}, {"mean", nullptr}, {"max", nullptr}};
  return {{"min", spread.least}, {"mean", spread.mean}, {"max", spread.most}};
}

Json json_of(const particle::Range& range) { return Json::array({range.low, range.high}); }

Json json_of(const particle::Protocol& protocol) {
  return {{"name", particle::protocol_names.name(protocol.kind)},
          {"speed_m_per_s", json_of(protocol.speed)},
          {"diameter_1_m", json_of(protocol.diameter_1)},
          {"diameter_2_m", json_of(protocol.diameter_2)},
          {"density_1_kg_per_m3", protocol.density_1},
          {"density_2_kg_per_m3", protocol.density_2},
          {"spin_speed_m_per_s", protocol.spin_speed},
          {"approach_time_s", json_of(protocol.approach_time)}};
}

Json json_of(const particle::ContactLaw& law) {
  Json json{{"name", particle::law_names.name(law.kind)},
            {"text", law.text()},
            {"restitution", law.restitution},
            {"friction", law.friction},
            {"tangential_restitution", json_of(law.tangential_restitution)}};
  if (law.kind == particle::LawKind::linear) {
    json["stiffness_n_per_m"] = law.stiffness;
  } else {
    json["youngs_modulus_pa"] = law.youngs_modulus;
    json["poisson_ratio"] = law.poisson_ratio;
  }
  return json;
}

std::string shown(const Json& value, const std::string& unit, int digits = 4) {
  return value.is_number() ? base::rounded(base::unit(unit).from_si(value.get<double>()), digits) : "-";
}

std::string range(const Json& ends, const std::string& unit) {
  const auto low = shown(ends[0], unit), high = shown(ends[1], unit);
  return (low == high ? low : low + " to " + high) + " " + unit;
}

std::string line(const char* what, const Json& spread, const std::string& unit) {
  const auto cell = [&](const char* key) { return shown(spread[key], unit); };
  return fmt::format("{:<36}{:<6}{:>12}{:>12}{:>12}\n", what, unit == "1" ? "" : unit, cell("min"),
                     cell("mean"), cell("max"));
}

std::string kinds(const Json& d) {
  const auto n = d["pairs"].get<double>();
  const auto kind = [&](const char* name, const char* key, const std::string& meaning) {
    const auto count = d[key].get<std::size_t>();
    return fmt::format("  {:<12}{:>10}{:>8.1f} %  {}\n", name, count, 100 * static_cast<double>(count) / n,
                       meaning);
  };
  return "\n" +
         kind("head-on", "head_on",
              fmt::format("velocities at least {} degrees apart", CollisionSummary::head_on_from)) +
         kind("crossing", "crossing", "velocities between") +
         kind("catching up", "catching_up",
              fmt::format("velocities at most {} degrees apart, or one sphere at rest",
                          CollisionSummary::catching_up_to)) +
         kind("grazing", "grazing",
              fmt::format("of any directions, hit more than {} degrees off the line of centres",
                          CollisionSummary::grazing_from));
}

/// The law, and what the pairs were drawn from.
std::string drawn(const Json& d) {
  const auto& protocol = d["protocol"];
  const auto& tangential = d["law"]["tangential_restitution"];
  auto text = fmt::format(
      "  contact law: {}{}\n"
      "  drawn: speeds {}, diameters {} and {}, densities {} and {} kg/m3, spins {}\n",
      d["law"]["text"].get<std::string>(),
      tangential.is_null() ? "" : ", tangential e " + shown(tangential, "1"),
      range(protocol["speed_m_per_s"], "m/s"), range(protocol["diameter_1_m"], "um"),
      range(protocol["diameter_2_m"], "um"), shown(protocol["density_1_kg_per_m3"], "kg/m3"),
      shown(protocol["density_2_kg_per_m3"], "kg/m3"),
      protocol["spin_speed_m_per_s"] == 0.0
          ? "none"
          : "with surfaces up to " + shown(protocol["spin_speed_m_per_s"], "m/s") + " m/s");
  if (!protocol["approach_time_s"].is_null())
    text += fmt::format("  spheres start {} us before they would meet at one point\n",
                        shown(protocol["approach_time_s"], "us"));
  return text;
}

std::string settings(const Json& d) {
  auto text =
      fmt::format("{} collisions of two spheres, protocol {}, seed {}\n", d["pairs"].get<std::size_t>(),
                  d["protocol"]["name"].get<std::string>(), d["seed"].get<std::uint64_t>()) +
      drawn(d);
  if (!d["speed_cap_m_per_s"].is_null())
    text += fmt::format("  velocities after the contact are cut to {} m/s\n",
                        shown(d["speed_cap_m_per_s"], "m/s"));
  return text;
}

std::string made_from(const Json& d) {
  std::string text;
  if (!d["provenance"].empty()) text += "\nmade from\n";
  for (const auto& [key, value] : d["provenance"].items())
    text += fmt::format("  {:<28}{}\n", key, value.get<std::string>());
  return text;
}

std::string model_words(const Json& d) {
  auto text = fmt::format("collision model: {}\nlearned from protocol {}\n", d["model"].get<std::string>(),
                          d["protocol"]["name"].get<std::string>()) +
              drawn(d) + made_from(d);
  if (!d["accuracy"].empty()) text += "\naccuracy\n" + d["accuracy"].dump(2) + "\n";
  return text;
}

std::string counted(const Json& d, const char* key, const char* what) {
  const auto n = d[key].get<std::size_t>();
  return n == 0 ? "" : fmt::format("{} {}\n", n, what);
}

}  // namespace

std::string energy_words(double lost) {
  return fmt::format("{:.3g} % of the kinetic energy {}", 100 * std::abs(lost), lost < 0 ? "gained" : "lost");
}

Json describe_collisions(const particle::CollisionSet& set) {
  const auto summary = particle::summarise(set);
  return {{"kind", "collisions"},
          {"pairs", summary.n_pairs},
          {"seed", set.seed},
          {"protocol", json_of(set.protocol)},
          {"law", json_of(set.law)},
          {"speed_cap_m_per_s", json_of(set.speed_cap)},
          {"head_on", summary.head_on},
          {"crossing", summary.crossing},
          {"catching_up", summary.catching_up},
          {"grazing", summary.grazing},
          {"speed", json_of(summary.speed)},
          {"relative_speed", json_of(summary.relative_speed)},
          {"speed_after", json_of(summary.speed_after)},
          {"impact_angle", json_of(summary.impact_angle)},
          {"diameter_1", json_of(summary.diameter_1)},
          {"diameter_2", json_of(summary.diameter_2)},
          {"overlap_share", json_of(summary.overlap_share)},
          {"duration", json_of(summary.duration)},
          {"surface_speed", json_of(summary.surface_speed)},
          {"surface_speed_after", json_of(summary.surface_speed_after)},
          {"energy_lost", summary.energy_lost},
          {"momentum_error", summary.momentum_error},
          {"started_overlapped", summary.started_overlapped},
          {"capped", summary.capped},
          {"stayed", summary.stayed},
          {"never_met", summary.never_met},
          {"provenance", set.provenance}};
}

Json describe_collision_model(const particle::CollisionBundle& bundle) {
  Json json{{"kind", "collision model"},
            {"surrogate", particle::surrogate_names.name(bundle.model->kind())},
            {"model", bundle.model->text()},
            {"protocol", json_of(bundle.protocol)},
            {"law", json_of(bundle.law)},
            {"provenance", bundle.provenance},
            {"accuracy", Json::parse(bundle.accuracy_json, nullptr, false)}};
  if (json["accuracy"].is_discarded()) json["accuracy"] = nullptr;
  return json;
}

std::string collision_words(const Json& d) {
  if (d["kind"] == "collision model") return model_words(d);
  auto text = settings(d) + kinds(d);
  text += fmt::format("\n{:<36}{:<6}{:>12}{:>12}{:>12}\n", "", "unit", "least", "mean", "most");
  text += line("speed of a sphere", d["speed"], "m/s") + line("speed afterwards", d["speed_after"], "m/s") +
          line("relative speed of a pair", d["relative_speed"], "m/s");
  // Degrees are what the summary counts in.
  text += fmt::format("{:<36}{:<6}{:>12}{:>12}{:>12}\n", "impact angle, 0: central", "deg",
                      shown(d["impact_angle"]["min"], "1"), shown(d["impact_angle"]["mean"], "1"),
                      shown(d["impact_angle"]["max"], "1"));
  text += line("diameter of sphere 1", d["diameter_1"], "um") +
          line("diameter of sphere 2", d["diameter_2"], "um") +
          line("greatest overlap, of the diameter", d["overlap_share"], "%") +
          line("duration of the contact", d["duration"], "us") +
          line("surface speed of the spin", d["surface_speed"], "m/s") +
          line("surface speed afterwards", d["surface_speed_after"], "m/s");
  text += fmt::format("\n{}; momentum kept to {:.1e}\n", energy_words(d["energy_lost"].get<double>()),
                      d["momentum_error"].get<double>());
  text += counted(d, "started_overlapped", "started overlapped") +
          counted(d, "capped", "left at the speed cap") +
          counted(d, "stayed", "did not part and go on as one body along the normal") +
          counted(d, "never_met", "never touched");
  return text + made_from(d);
}

}  // namespace elrom::programs
