#include "fuzz_collisions.hpp"

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/particle/chebyshev.hpp"
#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/collision_set.hpp"
#include "elrom/particle/collision_summary.hpp"
#include "elrom/particle/document_model.hpp"
#include "elrom/particle/exact_model.hpp"
#include "elrom/particle/frame_model.hpp"
#include "fuzz_bundles.hpp"
#include "memory_file.hpp"

namespace elrom::faults {
namespace {

namespace fs = std::filesystem;
using particle::CollisionBundle;

constexpr std::size_t n_pairs = 5;
const particle::Protocol protocol{.diameter_2 = {300e-6, 475e-6}, .spin_speed = 1};
const particle::ContactLaw law{.friction = 0.3, .stiffness = 1e5};

/// Every output a tree of two leaves.
particle::Trees small_trees(std::size_t n_inputs, std::size_t n_outputs) {
  std::vector<particle::TreeNode> nodes;
  std::vector<particle::TreeGroup> outputs;
  for (std::size_t k = 0; k < n_outputs; ++k) {
    const auto root = static_cast<std::int32_t>(nodes.size());
    outputs.push_back({.base = 0.1, .roots = {root}});
    nodes.insert(nodes.end(),
                 {{.feature = 0, .left = root + 1, .value = 0.5F}, {.value = 0.1F}, {.value = 0.2F}});
  }
  return {n_inputs, std::move(nodes), std::move(outputs)};
}

std::shared_ptr<const particle::Regressor> small_chebyshev(std::size_t n_inputs, std::size_t n_outputs) {
  const particle::Chebyshev::Shape shape{n_inputs, n_outputs, 2, 2};
  const auto rows = static_cast<Eigen::Index>(2 * shape.n_rows()),
             terms = static_cast<Eigen::Index>(shape.n_terms());
  return std::make_shared<particle::Chebyshev>(
      shape, std::vector<double>{0, 0.5, 1}, std::vector<double>(n_inputs, 0),
      std::vector<double>(n_inputs, 1), MatrixD::Constant(rows, terms, 0.1));
}

std::shared_ptr<const particle::CollisionModel> frame(std::shared_ptr<const particle::Regressor> regressor) {
  return std::make_shared<particle::FrameModel>(law, std::move(regressor), 0.1);
}

/// One of every kind of model.
std::vector<CollisionBundle> small_models() {
  const particle::DocumentPart part{math::Standardiser(Eigen::VectorXd::Zero(6), Eigen::VectorXd::Ones(6)),
                                    small_trees(6, 6)};
  std::vector<CollisionBundle> bundles;
  for (const auto& model : std::vector<std::shared_ptr<const particle::CollisionModel>>{
           std::make_shared<particle::ExactModel>(law), frame(small_chebyshev(2, 3)),
           frame(small_chebyshev(5, 5)), frame(std::make_shared<particle::Trees>(small_trees(2, 3))),
           std::make_shared<particle::DocumentModel>(part, particle::DocumentModel::Low{2, part})})
    bundles.push_back({.model = model, .protocol = protocol, .law = law});
  return bundles;
}

void read_and_summarise(const fs::path& path) {
  const auto summary = particle::summarise(particle::read_collisions(path));
  if (summary.n_pairs == 0) throw std::logic_error("a set without pairs");
}

void read_and_collide(const fs::path& path) {
  const auto bundle = CollisionBundle::read(path);
  static const auto pairs = particle::draw_pairs(protocol, 1, 0, n_pairs);
  particle::Impulses impulses(n_pairs);
  bundle.model->impulses(pairs, impulses);
}

const std::vector<std::string>& datasets() {
  static const std::vector<std::string> names = {
      "before/velocity_1", "before/velocity_2", "before/spin_1",   "before/spin_2",
      "after/velocity_1",  "after/velocity_2",  "after/spin_1",    "after/spin_2",
      "pair/normal",       "pair/diameter_1",   "pair/diameter_2", "pair/density_1",
      "pair/density_2",    "pair/overlap",      "contact/overlap", "contact/duration"};
  return names;
}

void change_dataset(const io::Hdf5File& file, Dice& dice) {
  const auto& name = datasets()[dice.below(datasets().size())];
  if (!file.has(name)) return;
  auto values = file.dataset(name).read<double>();
  auto shape = file.dataset(name).shape();
  const double hard = static_cast<double>(hard_numbers[dice.below(std::size(hard_numbers))]);
  switch (dice.below(4)) {
    case 0:
      file.remove(name);
      return;
    case 1: {  // another shape, which nothing but itself fits
      if (shape.empty()) return;
      auto& size = shape[dice.below(shape.size())];
      size = dice.below(7);
      std::size_t n = 1;
      for (const auto one : shape) n *= one;
      values.assign(n, 1.0);
      file.remove(name);
      file.write<double>(name, values, shape);
      return;
    }
    default:
      if (values.empty()) return;
      values[dice.below(values.size())] = dice.below(2) == 0 ? hard : std::pow(10.0, hard);
      file.dataset(name).write<double>(values);
  }
}

void change_attribute(const io::Hdf5File& file, Dice& dice) {
  static const std::vector<std::pair<std::string, std::string>> names = {{"protocol", "name"},
                                                                         {"protocol", "speed_low"},
                                                                         {"protocol", "speed_high"},
                                                                         {"protocol", "diameter_1_low"},
                                                                         {"protocol", "diameter_2_high"},
                                                                         {"protocol", "density_1"},
                                                                         {"protocol", "spin_speed"},
                                                                         {"protocol", "approach_time"},
                                                                         {"law", "name"},
                                                                         {"law", "restitution"},
                                                                         {"law", "friction"},
                                                                         {"law", "tangential_restitution"},
                                                                         {"law", "stiffness"},
                                                                         {"contact", "stayed"},
                                                                         {"contact", "steps"},
                                                                         {"/", "seed"},
                                                                         {"/", "speed_cap"},
                                                                         {"/", "provenance"},
                                                                         {"/", "provenance_names"},
                                                                         {"/", "format"}};
  const auto& [place, name] = names[dice.below(names.size())];
  const auto group = file.group(place);
  switch (dice.below(4)) {
    case 0:
      group.remove_attribute(name);
      return;
    case 1:
      group.set_text(name, std::string(dice.below(40), static_cast<char>(32 + dice.below(90))));
      return;
    case 2:
      group.set_texts(name, std::vector<std::string>(1 + dice.below(4), "hertz"));
      return;
    default:
      group.set_number(name, static_cast<double>(hard_numbers[dice.below(std::size(hard_numbers))]));
  }
}

particle::CollisionSet small_set() {
  auto set = particle::make_collisions(protocol, law, 1, 0, n_pairs, {});
  set.provenance = {{"made by", "a fuzzer"}};
  return set;
}

}  // namespace

std::vector<std::string> collision_seeds(const std::string& target) {
  if (target.ends_with("_content")) return {std::string(4, '\1'), std::string(24, '\2')};
  std::vector<std::string> seeds;
  const auto path = memory_folder() / ("seed_of_" + target);
  if (target == "collisions") {
    particle::write_collisions(path, small_set());
    seeds.push_back(test::read_bytes(path));
  } else {
    for (const auto& bundle : small_models()) {
      bundle.write(path);
      seeds.push_back(test::read_bytes(path));
    }
  }
  return seeds;
}

void fuzz_collisions(Bytes input) {
  try {
    read_and_summarise(memory_file("any.h5", input));
  } catch (const Error&) {
  }
}

void fuzz_collisions_content(Bytes input) {
  static const auto good = [] {
    const auto path = memory_folder() / "good_collisions.h5";
    particle::write_collisions(path, small_set());
    return test::read_bytes(path);
  }();
  const auto path =
      memory_file("content.h5", {reinterpret_cast<const std::uint8_t*>(good.data()), good.size()});
  try {
    Dice dice(input);
    auto file = io::Hdf5File::open(path, io::Hdf5File::Access::edit);
    while (!dice.used_up()) {
      if (dice.below(2) == 0)
        change_dataset(file, dice);
      else
        change_attribute(file, dice);
    }
    file.close();
    read_and_summarise(path);
  } catch (const Error&) {
  }
}

void fuzz_collision_model(Bytes input) {
  try {
    read_and_collide(memory_file("any_model.elrom", with_true_digest(input)));
  } catch (const Error&) {
  }
}

void fuzz_collision_model_content(Bytes input) {
  static const std::vector<io::TensorFile> good = [] {
    std::vector<io::TensorFile> files;
    for (const auto& bundle : small_models()) {
      const auto path = memory_folder() / ("model_" + std::to_string(files.size()) + ".elrom");
      bundle.write(path);
      files.push_back(io::TensorFile::open(path));
    }
    return files;
  }();
  try {
    Dice dice(input);
    auto file = good[dice.below(good.size())];
    change(file, dice);
    const auto path = memory_file("content_model.elrom", {});
    file.write(path);
    read_and_collide(path);
  } catch (const Error&) {
  }
}

}  // namespace elrom::faults
