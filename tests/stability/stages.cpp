#include "stages.hpp"

#include <cmath>
#include <functional>
#include <numeric>

#include "../../data/check.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/study/kernel_method.hpp"
#include "elrom/study/networks_method.hpp"
#include "elrom/study/peers.hpp"

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
study::Settings tiny_settings() {
  study::Settings settings;
  settings.threads = 1;
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
  const study::NetworksMethod networks(settings, nullptr);
  std::vector<std::size_t> rows(data.cases.n_cases());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  for (std::size_t f = 0; f < data.fields.size(); ++f) {
    const study::FieldData field{&data.cases, data.fields[f], data.values[f]};
    const auto result = networks.screen_field(field, rows, {});
    if (!result.error.allFinite() || !result.build_error.allFinite()) return "errors that are not finite";
  }
  return {};
}

struct NamedMethod {
  std::string stage;
  std::unique_ptr<study::Method> method;
};

/// Every method that needs no trainer.
std::vector<NamedMethod> all_methods() {
  std::vector<NamedMethod> methods;
  for (const auto& name : study::peer_names()) methods.push_back({name, study::make_peer(name)});
  methods.push_back({"kernel", study::make_kernel_method()});
  return methods;
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

std::string fit_and_predict(const HardData& data, const study::Method& method, const fs::path& path) {
  model::Bundle bundle;
  bundle.info.method = method.name();
  bundle.info.fields = data.fields;
  bundle.info.schema = data.cases.schema;
  bundle.info.cases = data.cases.names;
  bundle.mesh = data.cases.mesh;
  bundle.guard = model::Guard(data.cases.schema, data.cases.inputs, data.cases.names, data.cases.loads);
  std::vector<std::size_t> rows(data.cases.n_cases());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  for (std::size_t f = 0; f < data.fields.size(); ++f) {
    const study::FieldData field{&data.cases, data.fields[f], data.values[f]};
    bundle.models[data.fields[f].name] = method.fit(field, rows, {});
  }
  bundle.write(path);

  const model::Predictor predictor(path);
  model::Predictor::Scratch scratch;
  std::vector<float> values(predictor.size());
  const auto complaint_on = [&](const MatrixD& queries) -> std::string {
    for (Eigen::Index i = 0; i < queries.rows(); ++i) {
      const std::vector<double> inputs(queries.row(i).begin(), queries.row(i).end());
      predictor.predict(inputs, values, {}, scratch);
      if (auto wrong = wrong_values(values, predictor.fields()); !wrong.empty()) return wrong;
    }
    return {};
  };
  if (auto wrong = complaint_on(data.cases.inputs); !wrong.empty()) return wrong + " at a training case";
  if (auto wrong = complaint_on(far_queries(data.cases.inputs)); !wrong.empty())
    return wrong + " far outside";
  return {};
}

/// The guard must call every far query outside, and no training case.
std::string guard(const HardData& data) {
  const model::Guard guard(data.cases.schema, data.cases.inputs, data.cases.names, data.cases.loads);
  const auto far = far_queries(data.cases.inputs);
  for (Eigen::Index i = 0; i < far.rows(); ++i) {
    const std::vector<double> inputs(far.row(i).begin(), far.row(i).end());
    const auto assessment = guard.assess(inputs);
    if (assessment.verdict != model::Verdict::outside)
      return "far query " + std::to_string(i) + " is not called outside";
    if (!std::isfinite(assessment.distance) || assessment.reason.empty())
      return "an assessment without distance or reason";
  }
  return {};
}

}  // namespace

MatrixD far_queries(const MatrixD& inputs) {
  constexpr Eigen::Index n_corners = 64;
  const Eigen::RowVectorXd low = inputs.colwise().minCoeff(), high = inputs.colwise().maxCoeff();
  const Eigen::RowVectorXd middle = 0.5 * low + 0.5 * high;
  // An input that never changed still has a size by which it can be wrong.
  const Eigen::RowVectorXd range = (high - low).cwiseMax(0.1 * middle.cwiseAbs()).cwiseMax(1e-12);
  MatrixD queries(n_corners + 5, inputs.cols());
  base::Random random(base::Seed(11).derive("corners"));
  for (Eigen::Index i = 0; i < n_corners; ++i) {
    for (Eigen::Index k = 0; k < inputs.cols(); ++k) {
      queries(i, k) = random.below(2) == 0 ? low(k) - 10 * range(k) : high(k) + 10 * range(k);
    }
  }
  queries.row(n_corners) = low - 10 * range;
  queries.row(n_corners + 1) = high + 10 * range;
  queries.row(n_corners + 2) = -10 * high.cwiseAbs().cwiseMax(1);
  queries.row(n_corners + 3) = 1e6 * high.cwiseAbs().cwiseMax(1);
  queries.row(n_corners + 4).setConstant(1e300);
  return queries;
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
  for (const auto& [stage, method] : all_methods()) {
    const auto path = folder / (data.name + "_" + stage + ".elrom");
    outcomes.push_back(
        attempt(data, stage, [&, &model = *method] { return fit_and_predict(data, model, path); }));
  }
  return outcomes;
}

}  // namespace elrom::stability
