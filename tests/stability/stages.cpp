#include "stages.hpp"

#include <cmath>
#include <functional>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/field/symmetry.hpp"
#include "elrom/ingest/check.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/methods/networks_method.hpp"
#include "elrom/methods/peers.hpp"
#include "elrom/methods/pod_mlp.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/model/predictor.hpp"
#include "support/recording_log.hpp"
#if ELROM_HAS_TORCH
#include "elrom/torch/trainer.hpp"
#endif

namespace elrom::stability {
namespace {

namespace fs = std::filesystem;

/// `work` gives a complaint, or nothing when all is finite.
Outcome attempt(const HardData& data, const std::string& stage, const std::function<std::string()>& work) {
  try {
    const auto complaint = work();
    return {data.name, stage, complaint.empty(), complaint.empty() ? "finite" : complaint};
  } catch (const Error& error) {
    return {data.name, stage, true, std::string("refused: ") + error.what()};
  } catch (const std::exception& error) {
    return {data.name, stage, false, std::string("unexpected: ") + error.what()};
  }
}

std::string store_and_read(const HardData& data, const fs::path& path) {
  {
    field::SnapshotWriter writer(path, data.cases.mesh, data.cases.schema, data.fields);
    for (std::size_t i = 0; i < data.cases.n_cases(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      field::Snapshot snapshot;
      snapshot.record.inputs = {data.cases.names[i], data.cases.loads[i], {}};
      for (const double v : data.cases.inputs.row(row)) snapshot.record.inputs.values.push_back(v);
      snapshot.fields.resize(static_cast<Eigen::Index>(data.fields.size()), data.values[0].cols());
      for (std::size_t f = 0; f < data.fields.size(); ++f) {
        snapshot.fields.row(static_cast<Eigen::Index>(f)) = data.values[f].row(row);
      }
      writer.add(snapshot);
    }
    writer.commit();
  }
  const auto store = field::SnapshotStore::open(path);
  std::vector<std::size_t> all(store.n_cases());
  std::iota(all.begin(), all.end(), std::size_t{0});
  for (std::size_t f = 0; f < data.fields.size(); ++f) {
    const auto values = store.read(data.fields[f].name, all);
    if (!values.allFinite()) return "the store took cells that are not finite";
    if (values != data.values[f]) return "the store gives back other values";
  }
  return {};
}

std::string check(const HardData& data) {
  ingest::Checker checker;
  MatrixF values(static_cast<Eigen::Index>(data.fields.size()), data.values[0].cols());
  for (std::size_t i = 0; i < data.cases.n_cases(); ++i) {
    field::CaseRecord record;
    record.inputs = {data.cases.names[i], data.cases.loads[i], {}};
    for (const double v : data.cases.inputs.row(static_cast<Eigen::Index>(i)))
      record.inputs.values.push_back(v);
    for (std::size_t f = 0; f < data.fields.size(); ++f) {
      values.row(static_cast<Eigen::Index>(f)) = data.values[f].row(static_cast<Eigen::Index>(i));
    }
    checker.add(ingest::view_of(record, values, data.cases.mesh, data.cases.schema, data.fields));
  }
  const auto findings = checker.findings();
  const bool told = std::any_of(findings.begin(), findings.end(),
                                [](const ingest::Finding& f) { return f.kind == "not_finite"; });
  if (told != data.must_be_refused)
    return told ? "a false alarm of cells not finite" : "cells not finite overlooked";
  return {};
}

/// Small enough that every band of a hard field is searched and built within a second.
networks::Settings tiny_settings() {
  networks::Settings settings;
  settings.screen.builds = 2;
  settings.screen.max_epochs = 10;
  settings.search.trials = 2;
  settings.search.confirm = 1;
  settings.search.confirm_seeds = 1;
  settings.search.max_epochs = 5;
  settings.search.n_units = {16, 32};
  settings.fit.builds = 2;
  settings.fit.max_epochs = 10;
  return settings;
}

std::string screen(const HardData& data, const std::string& method) {
  auto settings = tiny_settings();
  settings.screen.method = method;
  const methods::NetworksMethod networks(settings, nullptr);
  std::vector<std::size_t> rows(data.cases.n_cases());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  for (std::size_t f = 0; f < data.fields.size(); ++f) {
    const field::FieldData field{&data.cases, data.fields[f], data.values[f]};
    const auto result = networks.screen_field(field, rows, {});
    if (!result.error.allFinite() || !result.build_error.allFinite()) return "errors that are not finite";
  }
  return {};
}

using Fit =
    std::function<std::unique_ptr<model::FieldModel>(const field::FieldData&, const methods::FitContext&)>;

std::unique_ptr<model::FieldModel> fit_with(const methods::Method& method, const field::FieldData& data,
                                            const methods::FitContext& context) {
  std::vector<std::size_t> rows(data.cases->n_cases());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return method.fit(data, rows, context);
}

Fit fit_by(std::shared_ptr<const methods::Method> method) {
  return [method = std::move(method)](const field::FieldData& data, const methods::FitContext& context) {
    return fit_with(*method, data, context);
  };
}

std::unique_ptr<model::FieldModel> fit_blend(const field::FieldData& data,
                                             const methods::FitContext& context) {
  std::vector<model::BlendModel::Member> parts;
  for (const std::string name : {"linear", "pod_rbf"})
    parts.push_back({{0.5}, fit_with(*methods::make_peer(name), data, context)});
  return std::make_unique<model::BlendModel>(std::move(parts));
}

std::unique_ptr<model::FieldModel> fit_mirror(const field::FieldData& data,
                                              const methods::FitContext& context) {
  const auto& cases = *data.cases;
  return std::make_unique<model::MirrorModel>(
      fit_with(*methods::make_peer("pod_gp"), data, context),
      field::symmetry_group(cases.mirrors, cases.schema.size(), cases.mesh.n_cells()), data.info.parity,
      cases.mesh.n_planes);
}

#if ELROM_HAS_TORCH
std::shared_ptr<const methods::Method> networks(const networks::Settings& settings) {
  return std::make_shared<methods::NetworksMethod>(settings, torch::make_torch_trainer());
}

/// Rates of which some diverge: those trials lose, and that is told.
std::unique_ptr<model::FieldModel> fit_diverging_search(const field::FieldData& data,
                                                        const methods::FitContext& context) {
  auto settings = tiny_settings();
  settings.search.learning_rate = {1e-20, 1e20};
  settings.search.trials = 6;
  test::RecordingLog log;
  auto listened = context;
  listened.log = &log;
  auto model = fit_with(*networks(settings), data, listened);
  if (log.text().find("diverged and are lost") == std::string::npos)
    throw std::runtime_error("lost trials were not told");
  return model;
}

/// Rates that leave nothing to win with.
std::unique_ptr<model::FieldModel> fit_diverging(const field::FieldData& data,
                                                 const methods::FitContext& context) {
  auto settings = tiny_settings();
  settings.search.learning_rate = {1e29, 1e30};
  (void)fit_with(*networks(settings), data, context);
  throw std::runtime_error("networks that diverged were taken");
}
#endif

struct NamedFit {
  std::string stage;
  Fit fit;
};

/// Every method, and every kind of model that is made of others.
std::vector<NamedFit> all_fits() {
  std::vector<NamedFit> fits;
  for (const auto& name : methods::closed_form_peers())
    fits.push_back({name, fit_by(methods::make_peer(name))});
  fits.push_back({"kernel", fit_by(methods::make_kernel_method())});
  fits.push_back({"blend", fit_blend});
  fits.push_back({"mirror", fit_mirror});
#if ELROM_HAS_TORCH
  fits.push_back({"networks", fit_by(networks(tiny_settings()))});
  auto averaged = tiny_settings();
  averaged.networks.mirrors = false;
  averaged.networks.average = true;
  averaged.bands.scope = "plane";
  fits.push_back({"networks_averaged", fit_by(networks(averaged))});
  fits.push_back({"pod_mlp", fit_by(methods::make_pod_mlp(
                                 torch::make_torch_trainer(),
                                 {.builds = 2, .recipes = {{{}, {20, 10}}}, .mirrors = true}))});
  fits.push_back({"diverging_search", fit_diverging_search});
  fits.push_back({"diverging_fit", fit_diverging});
#endif
  return fits;
}

std::string wrong_values(const std::vector<float>& values, const std::vector<field::FieldInfo>& fields) {
  const auto per_field = values.size() / fields.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& info = fields[i / per_field];
    if (!std::isfinite(values[i])) return info.name + " is not finite";
    if (info.lower && values[i] < static_cast<float>(*info.lower)) return info.name + " below its bound";
    if (info.upper && values[i] > static_cast<float>(*info.upper)) return info.name + " above its bound";
  }
  return {};
}

std::string wrong_widths(const std::vector<float>& widths) {
  const auto good = [](float width) { return std::isfinite(width) && width >= 0; };
  return std::all_of(widths.begin(), widths.end(), good) ? "" : "the half-width of an interval is not finite";
}

std::string fit_and_predict(const HardData& data, const std::string& stage, const Fit& fit,
                            const fs::path& path) {
  model::Bundle bundle;
  bundle.info.method = stage;
  bundle.info.fields = data.fields;
  bundle.info.schema = data.cases.schema;
  bundle.info.cases = data.cases.names;
  bundle.mesh = data.cases.mesh;
  bundle.guard = model::Guard(data.cases.schema, data.cases.inputs, data.cases.names, data.cases.loads);
  model::Selection selection;
  for (std::size_t f = 0; f < data.fields.size(); ++f) {
    const field::FieldData field{&data.cases, data.fields[f], data.values[f]};
    bundle.models[data.fields[f].name] = fit(field, {});
    if (data.cases.n_cases() < 3) continue;  // too few for an interval
    selection.interval_level = 0.5;
    const MatrixF residuals = data.values[f].rowwise() - data.values[f].row(0);
    bundle.uncertainty[data.fields[f].name] =
        std::make_shared<model::Uncertainty>(residuals, data.cases.mesh.n_columns, data.cases.inputs);
  }
  bundle.write(path);

  const model::Predictor predictor(path, selection);
  model::Predictor::Scratch scratch;
  std::vector<float> values(predictor.size()), widths(selection.interval_level ? predictor.size() : 0);
  const auto complaint_on = [&](const MatrixD& queries) -> std::string {
    for (Eigen::Index i = 0; i < queries.rows(); ++i) {
      const std::vector<double> inputs(queries.row(i).begin(), queries.row(i).end());
      predictor.predict(inputs, values, widths, scratch);
      if (auto wrong = wrong_values(values, predictor.fields()); !wrong.empty()) return wrong;
      if (auto wrong = wrong_widths(widths); !wrong.empty()) return wrong;
    }
    return {};
  };
  if (auto wrong = complaint_on(data.cases.inputs); !wrong.empty()) return wrong + " at a training case";
  if (auto wrong = complaint_on(box_corners(data.cases.inputs)); !wrong.empty())
    return wrong + " in a corner";
  if (auto wrong = complaint_on(far_queries(data.cases.inputs)); !wrong.empty())
    return wrong + " far outside";
  return {};
}

/// The guard must call every far query outside, and every corner of a box that the cases hardly fill.
std::string guard(const HardData& data) {
  const model::Guard guard(data.cases.schema, data.cases.inputs, data.cases.names, data.cases.loads);
  const auto complaint_on = [&](const MatrixD& queries, const std::string& name) -> std::string {
    for (Eigen::Index i = 0; i < queries.rows(); ++i) {
      const std::vector<double> inputs(queries.row(i).begin(), queries.row(i).end());
      const auto assessment = guard.assess(inputs);
      if (assessment.verdict != model::Verdict::outside)
        return name + " " + std::to_string(i) + " is not called outside";
      if (!std::isfinite(assessment.distance) || assessment.reason.empty())
        return "an assessment without distance or reason";
    }
    return {};
  };
  if (auto wrong = complaint_on(far_queries(data.cases.inputs), "far query"); !wrong.empty()) return wrong;
  return data.corners_are_outside ? complaint_on(box_corners(data.cases.inputs), "corner") : "";
}

}  // namespace

namespace {

constexpr Eigen::Index n_corners = 64;

struct Box {
  Eigen::RowVectorXd low, high, range;

  explicit Box(const MatrixD& inputs) : low(inputs.colwise().minCoeff()), high(inputs.colwise().maxCoeff()) {
    // An input that never changed still has a size by which it can be wrong.
    const Eigen::RowVectorXd middle = 0.5 * low + 0.5 * high;
    range = (high - low).cwiseMax(0.1 * middle.cwiseAbs()).cwiseMax(1e-12);
  }
  /// A corner of the box that reaches so many ranges further in every direction.
  [[nodiscard]] Eigen::RowVectorXd corner(double beyond, base::Random& random) const {
    Eigen::RowVectorXd point(low.size());
    for (Eigen::Index k = 0; k < low.size(); ++k)
      point[k] = random.below(2) == 0 ? low[k] - beyond * range[k] : high[k] + beyond * range[k];
    return point;
  }
};

}  // namespace

MatrixD box_corners(const MatrixD& inputs) {
  const Box box(inputs);
  base::Random random(base::Seed(11).derive("box"));
  MatrixD corners(n_corners, inputs.cols());
  for (Eigen::Index i = 0; i < n_corners; ++i) corners.row(i) = box.corner(0, random);
  return corners;
}

MatrixD far_queries(const MatrixD& inputs) {
  const Box box(inputs);
  const Eigen::RowVectorXd size = box.high.cwiseAbs().cwiseMax(1);
  base::Random random(base::Seed(11).derive("corners"));
  std::vector<Eigen::RowVectorXd> queries;
  for (Eigen::Index i = 0; i < n_corners; ++i) queries.push_back(box.corner(10, random));
  for (Eigen::Index i = 0; i < n_corners; ++i) queries.push_back(box.corner(random.uniform(0.2, 10), random));
  for (Eigen::Index k = 0; k < inputs.cols(); ++k) {  // one input alone
    for (const double beyond : {-10.0, -1.0, 1.0, 10.0}) {
      queries.push_back(inputs.row(0));
      queries.back()[k] = (beyond < 0 ? box.low : box.high)[k] + beyond * box.range[k];
    }
  }
  queries.insert(queries.end(), {box.low - 10 * box.range, box.high + 10 * box.range,
                                 Eigen::RowVectorXd::Zero(inputs.cols()), -10 * size, 1e6 * size,
                                 Eigen::RowVectorXd::Constant(inputs.cols(), 1e300),
                                 Eigen::RowVectorXd::Constant(inputs.cols(), -1e300)});
  MatrixD rows(static_cast<Eigen::Index>(queries.size()), inputs.cols());
  for (std::size_t i = 0; i < queries.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = queries[i];
  return rows;
}

std::vector<Outcome> send_through(const HardData& data, const fs::path& folder) {
  std::vector<Outcome> outcomes;
  auto stored = attempt(data, "store", [&] { return store_and_read(data, folder / (data.name + ".h5")); });
  if (data.must_be_refused && stored.result == "finite")
    stored = {data.name, "store", false, "was not refused"};
  outcomes.push_back(stored);
  outcomes.push_back(attempt(data, "check", [&] { return check(data); }));
  if (data.must_be_refused) return outcomes;  // nothing behind the store ever sees it
  outcomes.push_back(attempt(data, "guard", [&] { return guard(data); }));
  for (const std::string method : {"fast", "networks"}) {
    outcomes.push_back(attempt(data, "screen_" + method, [&] { return screen(data, method); }));
  }
  for (const auto& one : all_fits()) {
    const auto path = folder / (data.name + "_" + one.stage + ".elrom");
    outcomes.push_back(
        attempt(data, one.stage, [&] { return fit_and_predict(data, one.stage, one.fit, path); }));
  }
  return outcomes;
}

}  // namespace elrom::stability
