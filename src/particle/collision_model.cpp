#include "elrom/particle/collision_model.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/particle/document_model.hpp"
#include "elrom/particle/exact_model.hpp"
#include "elrom/particle/frame_model.hpp"

namespace elrom::particle {
namespace {

using Json = nlohmann::json;

Json json_of(const ContactLaw& law) {
  Json json{{"kind", law_names.name(law.kind)}, {"restitution", law.restitution}, {"friction", law.friction}};
  if (law.tangential_restitution) json["tangential_restitution"] = *law.tangential_restitution;
  if (law.kind == LawKind::linear) {
    json["stiffness"] = law.stiffness;
  } else {
    json["youngs_modulus"] = law.youngs_modulus;
    json["poisson_ratio"] = law.poisson_ratio;
  }
  return json;
}

std::optional<double> optional_number(const Json& json, const char* key) {
  if (!json.contains(key)) return std::nullopt;
  return json.at(key).get<double>();
}

ContactLaw law_of(const Json& json) {
  ContactLaw law;
  law.kind = law_names.value(json.at("kind").get<std::string>());
  law.restitution = json.at("restitution");
  law.friction = json.at("friction");
  law.tangential_restitution = optional_number(json, "tangential_restitution");
  law.stiffness = json.value("stiffness", law.stiffness);
  law.youngs_modulus = json.value("youngs_modulus", law.youngs_modulus);
  law.poisson_ratio = json.value("poisson_ratio", law.poisson_ratio);
  return law;
}

Json json_of(const Range& range) { return Json::array({range.low, range.high}); }

Range range_of(const Json& json) { return {json.at(0), json.at(1)}; }

Json json_of(const Protocol& protocol) {
  Json json{{"kind", protocol_names.name(protocol.kind)},
            {"speed", json_of(protocol.speed)},
            {"diameter_1", json_of(protocol.diameter_1)},
            {"diameter_2", json_of(protocol.diameter_2)},
            {"density_1", protocol.density_1},
            {"density_2", protocol.density_2},
            {"spin_speed", protocol.spin_speed}};
  if (protocol.approach_time) json["approach_time"] = *protocol.approach_time;
  return json;
}

Protocol protocol_of(const Json& json) {
  return {.kind = protocol_names.value(json.at("kind").get<std::string>()),
          .speed = range_of(json.at("speed")),
          .diameter_1 = range_of(json.at("diameter_1")),
          .diameter_2 = range_of(json.at("diameter_2")),
          .density_1 = json.at("density_1"),
          .density_2 = json.at("density_2"),
          .spin_speed = json.at("spin_speed"),
          .approach_time = optional_number(json, "approach_time")};
}

// `read(json)` of one of the file's texts. Whatever is wrong with it is the file's fault.
template <class Read>
auto from_text(const io::TensorFile& file, const char* key, const Read& read) {
  try {
    const auto value = read(Json::parse(file.text(key)));
    if constexpr (requires { value.check(); }) value.check();
    return value;
  } catch (const Json::exception&) {
    throw InputError(Problem{.what = std::string("unreadable ") + key, .where = file.where()});
  } catch (const UsageError& error) {
    throw InputError(Problem{.what = error.what(), .where = file.where()});
  }
}

std::shared_ptr<const CollisionModel> model_of(const io::TensorFile& file, const ContactLaw& law) {
  switch (surrogate_names.value(file.text("surrogate"))) {
    case SurrogateKind::document:
      return DocumentModel::read(file);
    case SurrogateKind::frame:
      return FrameModel::read(file, law);
    case SurrogateKind::exact:
      break;
  }
  return std::make_shared<ExactModel>(law);
}

Components per_sphere(const Components& impulses, const Scalars& divisor) {
  return impulses.colwise() / divisor;
}

}  // namespace

Impulses::Impulses(std::size_t n) {
  resize(n);
  for (auto* part : {&linear_1, &linear_2, &angular_1, &angular_2}) part->setZero();
}

void Impulses::resize(std::size_t n) {
  for (auto* part : {&linear_1, &linear_2, &angular_1, &angular_2})
    part->resize(static_cast<Eigen::Index>(n), 3);
}

Motion apply(const Pairs& pairs, const Impulses& impulses) {
  const Scalars mass_1 = sphere_mass(1, 1) * pairs.density_1 * pairs.diameter_1.cube();
  const Scalars mass_2 = sphere_mass(1, 1) * pairs.density_2 * pairs.diameter_2.cube();
  Motion after;
  after.velocity_1 = pairs.before.velocity_1 + per_sphere(impulses.linear_1, mass_1);
  after.velocity_2 = pairs.before.velocity_2 + per_sphere(impulses.linear_2, mass_2);
  // 2/5 m r^2
  after.spin_1 =
      pairs.before.spin_1 + per_sphere(impulses.angular_1, 0.1 * mass_1 * pairs.diameter_1.square());
  after.spin_2 =
      pairs.before.spin_2 + per_sphere(impulses.angular_2, 0.1 * mass_2 * pairs.diameter_2.square());
  return after;
}

void CollisionBundle::write(const std::filesystem::path& path) const {
  io::TensorFile file;
  io::write_kind(file, io::kinds::collision);
  file.set_text("surrogate", std::string(surrogate_names.name(model->kind())));
  file.set_text("law", json_of(law).dump());
  file.set_text("protocol", json_of(protocol).dump());
  file.set_text("provenance", Json(provenance).dump());
  file.set_text("accuracy", accuracy_json);
  model->write(file);
  file.write(path);
}

CollisionBundle CollisionBundle::read(const std::filesystem::path& path) {
  const auto file = io::TensorFile::open(path, io::Verify::on_use);
  io::check_kind(file, io::kinds::collision);
  CollisionBundle bundle;
  bundle.law = from_text(file, "law", law_of);
  bundle.protocol = from_text(file, "protocol", protocol_of);
  bundle.provenance = from_text(
      file, "provenance", [](const Json& json) { return json.get<std::map<std::string, std::string>>(); });
  bundle.accuracy_json = file.text("accuracy");
  bundle.model = model_of(file, bundle.law);
  return bundle;
}

}  // namespace elrom::particle
