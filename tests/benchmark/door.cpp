// bench-door: what the checks at import find of planted faults, and whether they object to sound cases. Every
// fault is planted into a case as exported; the case then comes to the reduced mesh and is judged among all
// the others, as import judges it, and alone, as the first case of a new store. Designed cases of another
// problem are all sound.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "elrom/ingest/check.hpp"
#include "elrom/ingest/onto_mesh.hpp"
#include "support/benchmark.hpp"
#include "support/planted_faults.hpp"

namespace elrom::benchmark {
namespace {

struct Options {
  bool small = false;
  int faults = 40, orders = 10, threads = base::available_threads();
  std::filesystem::path json, mesh = ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.h5";
  std::vector<std::string> folders;
};

struct Tally {
  int passed = 0, of = 0, alone = 0;
  std::map<std::string, int> by;  //!< kinds of findings
  std::vector<std::string> missed;
};

/// Another problem than a furnace: a plane of 20 x 20 cells, two smooth fields, one of any sign.
field::Mesh square() {
  constexpr std::size_t n = 20;
  field::Mesh mesh{.n_planes = n, .n_columns = n};
  mesh.centre = MatrixD::Zero(n * n, 3);
  for (Eigen::Index i = 0; i < mesh.centre.rows(); ++i) {
    mesh.centre(i, 0) = (static_cast<double>(i % n) + 0.5) / n;
    mesh.centre(i, 2) = (static_cast<double>(i / n) + 0.5) / n;
  }
  return mesh;
}

/// Cases of a Latin hypercube of inputs from 0 to 1.
std::vector<ingest::CfdCase> designed(const field::Mesh& mesh, std::size_t n_cases, std::size_t n_inputs,
                                      base::Random& random) {
  std::vector<field::InputInfo> inputs;
  std::vector<std::vector<double>> columns(n_inputs, std::vector<double>(n_cases));
  for (std::size_t j = 0; j < n_inputs; ++j) {
    inputs.push_back({"input_" + std::to_string(j), "1", "1"});
    for (std::size_t i = 0; i < n_cases; ++i)
      columns[j][i] = (static_cast<double>(i) + random.uniform()) / static_cast<double>(n_cases);
    random.shuffle(columns[j]);
  }
  Eigen::MatrixXd directions(2, static_cast<Eigen::Index>(n_inputs));
  for (double& value : directions.reshaped()) value = random.normal();
  std::vector<ingest::CfdCase> cases(n_cases);
  for (std::size_t i = 0; i < n_cases; ++i) {
    auto& one = cases[i];
    one.schema = field::InputSchema(inputs);
    one.centre = mesh.centre;
    one.fields = {field::field_info("velocity_x", "m/s"), field::field_info("pressure", "Pa")};
    one.record.inputs = {.name = "case_" + std::to_string(i), .load = NAN};
    for (const auto& column : columns) one.record.inputs.values.push_back(column[i]);
    const Eigen::Map<const Eigen::VectorXd> values(one.record.inputs.values.data(), directions.cols());
    const Eigen::Vector2d d = directions * (values.array() - 0.5).matrix();
    const double sum = values.sum();
    one.values.resize(2, mesh.centre.rows());
    for (Eigen::Index c = 0; c < mesh.centre.rows(); ++c) {
      const double x = mesh.centre(c, 0), z = mesh.centre(c, 2);
      one.values(0, c) = static_cast<float>(std::sin((3 + d[0]) * x + d[1]) * std::exp(-sum * z) + d[0] * z);
      one.values(1, c) = static_cast<float>(std::cos(2 * z + d[0]) * (1 + d[1] * x) + sum * x * z);
    }
  }
  return cases;
}

/// Designs of 20 to 200 cases that raise no alarm, by their number of inputs.
nlohmann::ordered_json judge_designs(int n_designs) {
  const auto mesh = square();
  nlohmann::ordered_json json;
  for (const std::size_t n_inputs : {2U, 3U, 4U}) {
    int sound = 0;
    for (int k = 0; k < n_designs; ++k) {
      base::Random random(base::Seed(3).derive("design").derive(static_cast<std::uint64_t>(k)));
      constexpr std::array<std::size_t, 4> sizes{20, 50, 100, 200};
      ingest::Checker checker;
      for (const auto& one : designed(mesh, sizes[static_cast<std::size_t>(k) % 4], n_inputs, random))
        checker.add(ingest::view_of(one, &mesh));
      const auto findings = checker.findings();
      sound +=
          std::ranges::all_of(findings, [](const auto& f) { return f.severity == ingest::Severity::note; });
    }
    fmt::print("designs of {} inputs  {:>3} of {} without alarm\n", n_inputs, sound, n_designs);
    json[std::to_string(n_inputs)] = {{"passed", sound}, {"of", n_designs}};
  }
  return json;
}

class Door {
 public:
  explicit Door(const Options& options)
      : options_(options),
        mesh_(field::read_mesh(options.mesh)),
        furnace_(field::read_furnace(std::filesystem::path(options.mesh).replace_extension(".toml"))) {
    for (const auto& folder : options.folders) {
      for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".h5") files_.push_back(entry.path());
    }
    std::sort(files_.begin(), files_.end(),
              [](const auto& a, const auto& b) { return a.filename() < b.filename(); });
    if (options.small) thin(16);
    if (files_.size() < 2) throw InputError({.what = "no cases", .where = options.folders.front()});
    fields_ = furnace_.limited({field::standard_fields().begin(), field::standard_fields().end()});
  }

  nlohmann::ordered_json run() {
    const Stopwatch watch;
    read_all();
    nlohmann::ordered_json json{{"cases", files_.size()}};
    const auto alarms = false_alarms();
    for (const auto& alarm : alarms) fmt::print("false alarm: {}\n", alarm);
    json["false_alarms"] = alarms.size();
    json["stores_without_alarm"] = n_stores_;
    json["designs"] = judge_designs(options_.small ? 4 : 24);
    json["kinds"] = nlohmann::ordered_json::object();
    for (const auto& fault : test::planted_faults()) json["kinds"][fault.kind] = report(fault, plant(fault));
    json["seconds"] = watch.seconds();
    return json;
  }

 private:
  void thin(std::size_t n) {
    std::vector<std::filesystem::path> some;
    for (std::size_t i = 0; i < n && files_.size() > 0; ++i) some.push_back(files_[i * files_.size() / n]);
    files_ = some;
  }

  void add(ingest::Checker& checker, ingest::OntoMesh& onto_mesh, const ingest::CfdCase& one) const {
    const auto snapshot = onto_mesh.bring(one, schema_, fields_);
    checker.add(ingest::view_of(snapshot.record, snapshot.fields, mesh_, schema_, fields_, &furnace_,
                                onto_mesh.coverage()));
  }

  void read_all() {
    for (int t = 0; t < options_.threads; ++t)
      onto_mesh_.push_back(std::make_unique<ingest::OntoMesh>(mesh_, 1));
    for (const auto& file : files_) {
      const auto one = ingest::read_el3d(file);
      if (schema_.size() == 0) schema_ = one.schema;
      add(all_, *onto_mesh_[0], one);
    }
  }

  static std::vector<ingest::Finding> serious(const ingest::Checker& checker) {
    auto findings = checker.findings();
    std::erase_if(findings, [](const auto& f) { return f.severity == ingest::Severity::note; });
    return findings;
  }

  [[nodiscard]] ingest::Checker store_of(const std::vector<std::string>& names, std::size_t first,
                                         std::size_t end) const {
    auto some = all_;
    const auto at = [&](std::size_t i) { return names.begin() + static_cast<std::ptrdiff_t>(i); };
    std::set<std::string> others(names.begin(), at(first));
    others.insert(at(end), names.end());
    some.forget(others);
    return some;
  }

  /// All cases in one store, each as the first of a store, and stores that grow in several orders by batches
  /// of several sizes: what stands in a store is never told, and so what comes into one is not either.
  std::vector<std::string> false_alarms() {
    std::vector<std::string> alarms, names;
    const auto judge = [&](const ingest::Checker& checker) {
      ++n_stores_;
      for (const auto& finding : serious(checker))
        alarms.push_back(fmt::format("among {}: {}", checker.cases().size(), ingest::line_of(finding)));
    };
    for (const auto& one : all_.cases()) names.push_back(one.name);
    judge(all_);
    for (std::size_t i = 0; i < names.size(); ++i) judge(store_of(names, i, i + 1));
    for (int order = 0; order < options_.orders; ++order) {
      base::Random random(base::Seed(2).derive("order").derive(static_cast<std::uint64_t>(order)));
      random.shuffle(names);
      for (std::size_t n = 2 + random.below(3); n < names.size(); n += 1 + random.below(n))
        judge(store_of(names, 0, n));
    }
    return alarms;
  }

  Tally plant(const test::PlantedFault& fault) const {
    const auto n = std::min<std::size_t>(files_.size(), static_cast<std::size_t>(options_.faults));
    Tally tally;
    std::mutex guard;
    std::vector<ingest::CfdCase> cases;
    for (std::size_t k = 0; k < n; ++k) cases.push_back(ingest::read_el3d(files_[k * files_.size() / n]));
    base::parallel_for(n, options_.threads, [&](std::size_t k, int thread) {
      auto& one = cases[k];
      fault.plant(one, k);
      const auto [found, found_alone] = judge(one, *onto_mesh_[static_cast<std::size_t>(thread)]);
      const std::lock_guard lock(guard);
      ++tally.of;
      tally.alone += found_alone.empty() ? 0 : 1;
      for (const auto& kind : found) ++tally.by[kind];
      if (found.empty())
        tally.missed.push_back(fmt::format("{} variant {}", one.record.inputs.name, k));
      else
        ++tally.passed;
      one = {};
    });
    return tally;
  }

  /// Kinds of findings on the case among the others, and alone.
  [[nodiscard]] std::pair<std::set<std::string>, std::set<std::string>> judge(
      const ingest::CfdCase& one, ingest::OntoMesh& onto_mesh) const {
    const auto& name = one.record.inputs.name;
    auto others = all_;
    others.forget({name});
    ingest::Checker alone;
    try {
      add(others, onto_mesh, one);
      add(alone, onto_mesh, one);
    } catch (const InputError&) {
      return {{"refused"}, {"refused"}};
    }
    const auto kinds = [&](const ingest::Checker& checker) {
      std::set<std::string> result;
      for (const auto& finding : ingest::findings_on(checker.findings(), name)) result.insert(finding.kind);
      return result;
    };
    return {kinds(others), kinds(alone)};
  }

  static nlohmann::ordered_json report(const test::PlantedFault& fault, const Tally& tally) {
    fmt::print("{:<20}{:>4} of {} found, {} of a store's first case\n", fault.kind, tally.passed, tally.of,
               tally.alone);
    for (const auto& miss : tally.missed) fmt::print("  missed: {}\n", miss);
    return {{"passed", tally.passed}, {"of", tally.of}, {"first_case", tally.alone}, {"by", tally.by}};
  }

  const Options& options_;
  field::Mesh mesh_;
  field::Furnace furnace_;
  field::InputSchema schema_;
  std::vector<field::FieldInfo> fields_;
  std::vector<std::filesystem::path> files_;
  ingest::Checker all_;
  std::vector<std::unique_ptr<ingest::OntoMesh>> onto_mesh_;  //!< one a thread
  int n_stores_ = 0;
};

int run(int argc, char** argv) {
  Options options;
  CommandLine line(
      "What the checks at import find of planted faults, and whether they object to sound cases.");
  line.add("--json", options.json, "write the figures to this file");
  line.add("--small", options.small, "a version that ends within a minute");
  line.add("--threads", options.threads, "threads");
  line.add("--faults", options.faults, "of each kind, at most one a case");
  line.add("--orders", options.orders, "in which stores of sound cases grow");
  line.add("--mesh", options.mesh, "reduced mesh, with its furnace description beside it");
  line.add_repeated("--cases", options.folders, "folder of EL3D exports; may be repeated [data/cases]");
  if (const auto status = line.parse(argc, argv)) return *status;
  if (options.folders.empty()) options.folders = {ELROM_SOURCE_DIR "/data/cases"};
  if (options.small) {
    options.faults = std::min(options.faults, 3);
    options.orders = std::min(options.orders, 2);
  }
  return show(Door(options).run(), options.small, options.json);
}

}  // namespace
}  // namespace elrom::benchmark

int main(int argc, char** argv) {
  return elrom::base::run_app("bench-door", [&] { return elrom::benchmark::run(argc, argv); });
}
