// bench-repeatable: does the last bit of the data move the result? All of `elrom-train run` on the cases as
// they are and on copies whose values and boundary conditions differ by up to a part in ten million, as
// another compiler, processor or BLAS would round them. The error on the held-out loads should differ by no
// more than 0.5 % in any field. What each field's answer is made of stands beside it: where that changes from
// copy to copy, a choice sits on an edge.

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/random.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace elrom;
using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

constexpr double perturbation = 1e-7, widest_spread = 0.005;

struct Options : benchmark::StudyArguments {
  int copies = 2;
};

double perturbed(double value, base::Random& random) {
  return value * (1 + perturbation * random.uniform(-1, 1));
}

/// Equal boundary conditions stay equal, so that repeated runs are still known as such.
void perturb(field::CaseInputs& inputs, base::Seed seed) {
  for (std::size_t i = 0; i < inputs.values.size(); ++i) {
    base::Random random(seed.derive(i).derive(std::bit_cast<std::uint64_t>(inputs.values[i])));
    inputs.values[i] = perturbed(inputs.values[i], random);
  }
}

/// @param copy 0: as it is
void write_copy(const field::SnapshotStore& store, int copy, const std::filesystem::path& path) {
  const auto seed = base::Seed(static_cast<std::uint64_t>(copy));
  field::SnapshotWriter writer(path, store.mesh(), store.schema(), store.fields(), store.furnace());
  for (std::size_t row = 0; row < store.n_cases(); ++row) {
    field::Snapshot snapshot{store.cases()[row], {}};
    snapshot.record.content_digest.clear();
    snapshot.fields.resize(static_cast<Eigen::Index>(store.fields().size()),
                           static_cast<Eigen::Index>(store.mesh().n_cells()));
    for (Eigen::Index f = 0; f < snapshot.fields.rows(); ++f)
      snapshot.fields.row(f) = store.read(store.fields()[static_cast<std::size_t>(f)].name, std::array{row});
    if (copy > 0) {
      perturb(snapshot.record.inputs, seed.derive("inputs"));
      base::Random random(seed.derive(snapshot.record.inputs.name));
      for (float& value : snapshot.fields.reshaped()) value = static_cast<float>(perturbed(value, random));
    }
    writer.add(snapshot);
  }
  writer.commit();
}

/// The report of one copy.
Json report_of(const field::SnapshotStore& store, int copy, const Options& options,
               const std::filesystem::path& folder) {
  const auto cases = folder / fmt::format("copy_{}.h5", copy);
  if (!std::filesystem::exists(cases)) write_copy(store, copy, cases);
  return benchmark::trained_report(options, folder / fmt::format("copy_{}", copy), cases);
}

Json compare(const std::vector<Json>& reports) {
  Json fields = Json::object();
  double worst = 0;
  for (std::size_t f = 0; f < reports.front()["fields"].size(); ++f) {
    std::vector<double> errors;
    Names answers;
    for (const auto& report : reports) {
      const auto& own = report["fields"][f]["methods"][0];
      errors.push_back(own["nrmse"]);
      answers.push_back(own.contains("detail") ? own["detail"] : own["kind"]);
    }
    const auto [least, most] = std::ranges::minmax(errors);
    const double spread = most / least - 1;
    worst = std::max(worst, spread);
    const std::string name = reports.front()["fields"][f]["field"];
    fmt::print("{:<24}", name);
    for (const double error : errors) fmt::print(" {:.4f}", error);
    fmt::print("  {:.3f} %  {}\n", 100 * spread, fmt::join(answers, " | "));
    fields[name] = {{"nrmse", errors}, {"spread", spread}, {"answers", answers}};
  }
  fmt::print("widest spread {:.3f} %: {}\n", 100 * worst, worst <= widest_spread ? "holds" : "FAILS");
  return {{"widest_spread", worst}, {"holds", worst <= widest_spread}, {"fields", fields}};
}

int run(const Options& options) {
  const test::TemporaryFolder temporary;
  const auto folder = options.folder.empty() ? temporary.path() : options.folder;
  std::filesystem::create_directories(folder);
  const auto store = field::SnapshotStore::open(options.store);
  std::vector<Json> reports;
  for (int copy = 0; copy <= options.copies; ++copy)
    reports.push_back(report_of(store, copy, options, folder));
  Json json{{"perturbation", perturbation}, {"effort", options.effort}, {"copies", options.copies}};
  json.update(compare(reports));
  if (!options.json.empty()) base::write_text(options.json, json.dump(1) + "\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return base::run_app("bench-repeatable", [&] {
    Options options;
    benchmark::CommandLine line(
        "Whether a change of the data in the last bit changes what a study makes of them (NRMSE of each field "
        "on the held-out cases).");
    options.add_to(line);
    line.add("--copies", options.copies, "copies of the data, each perturbed anew");
    if (const auto status = line.parse(argc, argv)) return *status;
    options.store = std::filesystem::absolute(options.store);
    if (options.small) {
      options.copies = 1;
      options.settings.insert(options.settings.end(),
                              {"fields.names=[\"pressure\"]", "peers.networks=false"});
    }
    return run(options);
  });
}
