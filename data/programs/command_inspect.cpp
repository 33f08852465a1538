#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/case_files.hpp"
#include "elrom/ingest/store_summary.hpp"

namespace elrom::programs {

namespace {

nlohmann::ordered_json describe(const std::filesystem::path& path) {
  const auto ending = path.extension();
  if (ending == ".elrom") return ingest::describe_bundle(model::BundleReader(path));
  if (ending == ".h5" || ending == ".hdf5" || ending == ".hdf") {
    const auto kind = ingest::kind_of(path);
    if (kind == io::kinds::snapshots.name) return ingest::describe_store(field::SnapshotStore::open(path));
    if (kind == io::kinds::mesh.name) return ingest::describe_mesh(field::read_mesh(path));
    if (kind == io::kinds::prediction.name) return ingest::describe_prediction(path);
    if (!kind.empty())
      throw InputError({.what = "nothing to inspect",
                        .where = path.string(),
                        .found = kind,
                        .expected = "a store, a mesh, a case, a bundle or a prediction"});
  }
  return ingest::describe_case(ingest::read_case(path));
}

}  // namespace

void add_inspect(CLI::App& program, Work& chosen) {
  struct Options {
    std::filesystem::path path;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  auto* command = program.add_subcommand(
      "inspect",
      R"(Say what is in a snapshot store, a reduced mesh, a CFD result, a bundle or a prediction:
cases, loads, inputs, fields, units.)");
  command->add_option("FILE", options->path, "Store, mesh, case, bundle (model.elrom) or prediction (.hdf)")
      ->required()
      ->type_name("FILE");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &chosen] {
    chosen = [options] {
      const auto description = describe(options->path);
      fmt::print("{}", options->json ? description.dump(2) + "\n" : ingest::in_words(description));
      return 0;
    };
  });
}

}  // namespace elrom::programs
