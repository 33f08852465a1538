#pragma once
// A trained study of a tiny made-up furnace: fields are smooth functions of two inputs and of place, so that
// methods can learn them, and the repeated runs differ by a known noise.

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/random.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/methods/peers.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/study/held_out.hpp"

namespace elrom::report {

class SmallStudy {
 public:
  static constexpr std::size_t n_training = 12;

  struct Options {
    std::string main_method = "linear";  ///< answers for every field of model.elrom
    std::size_t n_held_out = 2;          ///< at most six
    bool described = true;               ///< has a furnace description, with words of its own
    bool with_loads = true;
  };

  /// @param folder made anew
  explicit SmallStudy(std::filesystem::path folder) : SmallStudy(std::move(folder), Options()) {}
  SmallStudy(std::filesystem::path folder, Options options)
      : folder_(std::move(folder)), options_(std::move(options)) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "peers");
    write_store();
    write_models();
    base::write_text(folder_ / "timing.json",
                     R"({"kind": "elrom-timing", "format": [1, 0],
                         "stages": {"model": {"seconds": 3}}, "methods": {"auto": 2.5, "nearest": 0.25}})");
  }
  ~SmallStudy() { std::filesystem::remove_all(folder_); }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// A bundle trained on the cases whose names match the patterns.
  void train(const std::string& method, const std::vector<std::string>& patterns,
             const std::filesystem::path& path) const {
    const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");
    std::vector<std::size_t> rows;
    for (const auto& pattern : patterns)
      for (const auto row : store.find(pattern)) rows.push_back(row);
    write_bundle(store, case_set(store, rows), rows, method, path, false);
  }

 private:
  static std::vector<field::FieldInfo> fields() {
    return {field::field_info("gas_velocity_z"), field::field_info("pressure"),
            field::field_info("solid_volume_fraction")};
  }
  static field::InputSchema schema() {
    return field::InputSchema{{{"primary_air", "kg/s", "kg/s"}, {"gas_temperature", "K", "K"}}};
  }

  void write_store() {
    const auto mesh = field::make_furnace_mesh({}, 4, 3, 5);
    const field::Furnace furnace{.name = "small",
                                 .solid_density = 2400,
                                 .packing_limit = 0.65,
                                 .held_out = {"load_*", "rep*"},
                                 .repeats = {"rep*"},
                                 .openings = {{.inputs = "primary_air"}},
                                 .words = {"run", "runs", "LES"}};
    const auto described = options_.described ? std::optional(furnace) : std::nullopt;
    field::SnapshotWriter writer(folder_ / "snapshots.h5", mesh, schema(), fields(), described);
    base::Random random{base::Seed(3)};
    constexpr std::array held_out{0.52, 0.72, 0.43, 0.63, 0.83, 0.91};  // none is a training case's
    for (std::size_t i = 0; i < n_training; ++i)
      add_case(writer, mesh, "train_" + std::to_string(i), 0.4 + 0.05 * static_cast<double>(i), random);
    for (std::size_t i = 0; i < options_.n_held_out; ++i)
      add_case(writer, mesh, "load_" + std::to_string(n_training + i), held_out[i], random);
    for (int i = 1; i <= 2; ++i) add_case(writer, mesh, "rep" + std::to_string(i), held_out[0], random);
    writer.commit();
  }

  void add_case(field::SnapshotWriter& writer, const field::Mesh& mesh, const std::string& name, double load,
                base::Random& random) const {
    field::Snapshot snapshot;
    snapshot.record.inputs = {.name = name,
                              .load = options_.with_loads ? load : std::nan(""),
                              .values = {200 * load, 900 + 300 * load * load}};
    snapshot.record.source = name + ".h5";
    snapshot.record.source_digest = name;
    snapshot.fields.resize(3, static_cast<Eigen::Index>(mesh.n_cells()));
    for (Eigen::Index cell = 0; cell < snapshot.fields.cols(); ++cell) {
      const double z = mesh.centre(cell, 2) / 47, x = mesh.centre(cell, 0) / 10.6;
      snapshot.fields(0, cell) = static_cast<float>(5 * load * (1 + 0.3 * x) + 0.05 * random.normal());
      snapshot.fields(1, cell) = static_cast<float>(2000 * (1 - z) * (0.5 + load) + 5 * random.normal());
      snapshot.fields(2, cell) =
          static_cast<float>(0.1 * std::exp(-5 * z) * (1.2 - 0.5 * load) * (1 + 0.02 * random.normal()));
    }
    writer.add(snapshot);
  }

  static field::CaseSet case_set(const field::SnapshotStore& store, const std::vector<std::size_t>& rows) {
    field::CaseSet cases{store.mesh(), store.schema(), {}, {}, store.inputs(rows), {}};
    for (const auto row : rows) {
      cases.names.push_back(store.cases()[row].inputs.name);
      cases.loads.push_back(store.cases()[row].inputs.load);
    }
    return cases;
  }

  void write_models() const {
    const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");
    study::SplitNames split;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < store.n_cases(); ++i) {
      const auto& name = store.cases()[i].inputs.name;
      const bool training = name.starts_with("train");
      if (training) rows.push_back(i);
      (training ? split.train : split.held_out).push_back(name);
    }
    study::write_split(folder_ / "split.json", split);
    const auto cases = case_set(store, rows);
    write_bundle(store, cases, rows, options_.main_method, folder_ / "model.elrom", true);
    for (const std::string peer : {"nearest", "linear"})
      write_bundle(store, cases, rows, peer, folder_ / "peers" / (peer + ".elrom"), false);
  }

  /// As if one field had been blended by cross-validation.
  static std::string accuracy() {
    return R"({"gas_velocity_z": {"nrmse": 0.4, "nrmse_by_band": 0.39, "candidates": [
      {"name": "nearest", "nrmse": 0.5, "weight": 0.25}, {"name": "linear", "nrmse": 0.45, "weight": 0.75},
      {"name": "pod_gp", "nrmse": 0.6, "weight": 0, "left_after": 1},
      {"name": "networks", "nrmse": null, "weight": 0, "failure": "it diverged"}]}})";
  }

  static void write_bundle(const field::SnapshotStore& store, const field::CaseSet& cases,
                           const std::vector<std::size_t>& rows, const std::string& method,
                           const std::filesystem::path& path, bool with_uncertainty) {
    model::Bundle bundle;
    bundle.info = {.method = method, .fields = fields(), .schema = cases.schema, .cases = cases.names};
    if (with_uncertainty) bundle.info.accuracy_json = accuracy();
    bundle.mesh = cases.mesh;
    bundle.guard = model::Guard(cases.schema, cases.inputs, cases.names, cases.loads);
    std::vector<std::size_t> all(rows.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    for (const auto& info : fields()) {
      const field::FieldData data{&cases, info, store.read(info.name, rows)};
      bundle.models[info.name] = methods::make_peer(method)->fit(data, all, {});
      if (!with_uncertainty) continue;
      if (info.name == "gas_velocity_z") {  // over a scale of 1
        const model::Feature logarithm{"primary_air^0", {}};
        bundle.models[info.name] = std::make_shared<model::ScaledModel>(
            model::FeatureMap({logarithm}, cases.schema.size()), bundle.models[info.name]);
      }
      const auto folds = methods::load_grouped_folds(cases.loads, all, 4);
      const MatrixF residuals = data.values - methods::make_peer(method)->cross_predict(data, folds, {});
      bundle.uncertainty[info.name] = std::make_shared<model::Uncertainty>(residuals, cases.mesh.n_columns);
    }
    bundle.write(path);
  }

  std::filesystem::path folder_;
  Options options_;
};

}  // namespace elrom::report
