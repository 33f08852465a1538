#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "collision_words.hpp"
#include "commands.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/case_files.hpp"
#include "elrom/ingest/store_summary.hpp"

namespace elrom::programs {

namespace {

bool is_collision_model(const std::filesystem::path& path) {
  const auto file = io::TensorFile::open(path);
  return file.has_text("kind") && file.text("kind") == io::kinds::collision.name;
}

nlohmann::ordered_json describe(const std::filesystem::path& path) {
  const auto ending = path.extension();
  if (ending == ".elrom") {
    if (is_collision_model(path)) return describe_collision_model(particle::CollisionBundle::read(path));
    return ingest::describe_bundle(model::BundleReader(path));
  }
  if (ending == ".h5" || ending == ".hdf5" || ending == ".hdf") {
    const auto kind = ingest::kind_of(path);
    if (kind == io::kinds::snapshots.name) return ingest::describe_store(field::SnapshotStore::open(path));
    if (kind == io::kinds::mesh.name) return ingest::describe_mesh(field::read_mesh(path));
    if (kind == io::kinds::prediction.name) return ingest::describe_prediction(path);
    if (kind == io::kinds::collisions.name) return describe_collisions(particle::read_collisions(path));
    if (!kind.empty())
      throw InputError({.what = "nothing to inspect",
                        .where = path.string(),
                        .found = kind,
                        .expected = "a store, a mesh, a case, a bundle, a prediction or collisions"});
  }
  return ingest::describe_case(ingest::read_case(path));
}

std::string in_words(const nlohmann::ordered_json& description) {
  const bool collides = description["kind"] == "collisions" || description["kind"] == "collision model";
  return collides ? collision_words(description) : ingest::in_words(description);
}

}  // namespace

void add_inspect(cli::App& program, Work& chosen) {
  struct Options {
    std::filesystem::path path;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  auto* command = program.add_subcommand(
      "inspect",
      R"(Say what is in a snapshot store, a reduced mesh, a CFD result, a bundle, a prediction, a set of
collisions or a collision model: cases, loads, inputs, fields, units; kinds of collisions, speeds, energy lost.)");
  command
      ->add_option("FILE", options->path,
                   "Store, mesh, case, bundle (model.elrom), prediction (.hdf), collisions, collision model")
      ->required()
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &chosen] {
    chosen = [options] {
      const auto description = describe(options->path);
      fmt::print("{}", options->json ? description.dump(2) + "\n" : in_words(description));
      return 0;
    };
  });
}

}  // namespace elrom::programs
