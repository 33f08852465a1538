#include "elrom/ingest/generate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "generator_fields.hpp"

namespace elrom::ingest {

namespace {

// The divisor of n_columns that comes nearest to the shipped section's 20 x 42.
std::size_t cells_in_x(std::size_t n_columns) {
  constexpr double wanted = 20.0 / 42.0;
  std::size_t best = 1;
  const auto distance = [&](std::size_t n_x) {
    const auto x = static_cast<double>(n_x);
    return std::abs(std::log(x * x / static_cast<double>(n_columns) / wanted));
  };
  for (std::size_t n_x = 1; n_x * n_x <= n_columns; ++n_x) {
    if (n_columns % n_x == 0 && distance(n_x) < distance(best)) best = n_x;
  }
  return best;
}

std::vector<field::FieldInfo> generated_fields(std::size_t n) {
  const auto standard = field::standard_fields();
  std::vector<field::FieldInfo> fields(
      standard.begin(), standard.begin() + static_cast<std::ptrdiff_t>(std::min(n, standard.size())));
  for (std::size_t i = standard.size(); i < n; ++i) {
    auto tracer = field::field_info(fmt::format("tracer_{:02}", i - standard.size() + 1));
    tracer.meaning = "share of one inlet's gas";
    tracer.lower = 0.0;
    fields.push_back(tracer);
  }
  return fields;
}

void expect_sane(const GenerateOptions& options) {
  const auto expect = [](bool holds, const char* what, std::size_t found, const char* expected) {
    if (!holds)
      throw UsageError(
          {.what = std::string("number of ") + what, .found = std::to_string(found), .expected = expected});
  };
  expect(options.n_cases >= 1 && options.n_cases <= 1'000'000, "cases", options.n_cases, "1 to 1000000");
  expect(options.n_held_out <= 40, "held-out cases", options.n_held_out, "0 to 40");
  expect(options.n_fields >= 1 && options.n_fields <= 1000, "fields", options.n_fields, "1 to 1000");
  expect(options.n_inputs >= 1 && options.n_inputs <= 1000, "inputs", options.n_inputs, "1 to 1000");
  if (!(options.noise >= 0 && options.noise <= 10)) throw UsageError("noise must lie between 0 and 10");
  if (std::filesystem::exists(options.store))
    throw UsageError({.what = "there is already a file",
                      .where = options.store.string(),
                      .advice = "remove it, or choose another name"});
}

struct NamedPoint {
  std::string name;
  DesignPoint point;
};

std::vector<NamedPoint> design(const GenerateOptions& options, const std::vector<GeneratorInput>& inputs,
                               base::Seed seed) {
  std::vector<NamedPoint> cases;
  for (auto& point : latin_design(options.n_cases, inputs, seed.derive("design"))) {
    cases.push_back({fmt::format("train_{:03}", cases.size()), std::move(point)});
  }
  constexpr double lowest = 0.42, highest = 0.98;
  std::vector<double> loads;
  for (std::size_t i = 0; i < options.n_held_out; ++i) {
    const double share =
        options.n_held_out == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(options.n_held_out - 1);
    loads.push_back(lowest + (highest - lowest) * share);
  }
  for (auto& point : design_at(loads, inputs, seed.derive("held out"))) {
    cases.push_back({fmt::format("load_{:03}", std::llround(100 * point.load)), std::move(point)});
  }
  return cases;
}

field::InputSchema schema_of(const std::vector<GeneratorInput>& inputs) {
  std::vector<field::InputInfo> infos;
  for (const auto& input : inputs) infos.push_back(input.info);
  return field::InputSchema(std::move(infos));
}

}  // namespace

void generate(const GenerateOptions& options, Log& log, const std::stop_token& stop) {
  expect_sane(options);
  const base::Seed seed = base::Seed(options.seed).derive("generate");
  const auto n_x = cells_in_x(options.n_columns);
  const auto mesh = field::make_furnace_mesh({}, n_x, options.n_columns / n_x, options.n_planes);
  const auto inputs = generator_inputs(options.n_inputs, seed);
  const auto fields = generated_fields(options.n_fields);
  const FieldGenerator generator(mesh, n_x, inputs, fields, options.noise);
  const auto cases = design(options, inputs, seed);
  field::SnapshotWriter writer(options.store, mesh, schema_of(inputs), fields, generator_furnace(inputs));
  const auto batch = static_cast<std::size_t>(std::max(1, options.n_threads));
  std::vector<field::Snapshot> snapshots(batch);
  for (std::size_t begin = 0; begin < cases.size(); begin += batch) {
    const auto n = std::min(batch, cases.size() - begin);
    base::parallel_for(
        n, options.n_threads,
        [&](std::size_t i, int) {
          const auto& [name, point] = cases[begin + i];
          snapshots[i] = {.record = {.inputs = {name, point.load, point.values},
                                     .source = "generated, seed " + std::to_string(options.seed)},
                          .fields = generator.fields(point, seed.derive("case").derive(begin + i))};
        },
        stop);
    for (std::size_t i = 0; i < n; ++i) writer.add(snapshots[i]);
    log.progress({.task = "generate",
                  .done = static_cast<std::int64_t>(begin + n),
                  .total = static_cast<std::int64_t>(cases.size()),
                  .unit = "cases"});
  }
  writer.commit();
}

}  // namespace elrom::ingest
