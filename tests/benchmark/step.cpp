// bench-step: one training step of the LibTorch trainer against the matrix products it cannot do without, at
// their own shapes: forward, gradient of the weights, gradient of the inputs of every layer. One thread.

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <numeric>

#include "../../train/torch/training.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "support/benchmark.hpp"

namespace {

using namespace elrom;
using Clock = std::chrono::steady_clock;
using Sgemm = void (*)(const char*, const char*, const int*, const int*, const int*, const float*,
                       const float*, const int*, const float*, const int*, const float*, float*, const int*);

/// The sgemm that LibTorch itself calls.
Sgemm find_sgemm() {
  auto* symbol = dlsym(RTLD_DEFAULT, "sgemm_");
  if (symbol == nullptr) throw NotBuiltError(Problem{"no BLAS with an sgemm in this program"});
  return reinterpret_cast<Sgemm>(symbol);
}

struct Shape {
  int n_inputs, n_layers, n_units, n_outputs, batch;
};

/// C (m, n) = A (m, k) B (k, n), row-major.
struct Product {
  int m, n, k;
  std::vector<float> a, b, c;
  Product(int rows, int columns, int inner)
      : m(rows),
        n(columns),
        k(inner),
        a(size(rows, inner), 0.5F),
        b(size(inner, columns), 0.25F),
        c(size(rows, columns)) {}
  static std::size_t size(int rows, int columns) {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  }
  void run(Sgemm sgemm) {
    const float one = 1, zero = 0;
    sgemm("N", "N", &n, &m, &k, &one, b.data(), &n, a.data(), &k, &zero, c.data(), &n);
  }
  [[nodiscard]] double flops() const { return 2.0 * m * n * k; }
};

std::vector<Product> products_of(const Shape& shape) {
  std::vector<int> widths{shape.n_inputs};
  widths.insert(widths.end(), static_cast<std::size_t>(shape.n_layers), shape.n_units);
  widths.push_back(shape.n_outputs);
  std::vector<Product> products;
  for (std::size_t i = 1; i < widths.size(); ++i) {
    products.emplace_back(shape.batch, widths[i], widths[i - 1]);
    products.emplace_back(widths[i], widths[i - 1], shape.batch);
    if (i > 1) products.emplace_back(shape.batch, widths[i - 1], widths[i]);
  }
  return products;
}

template <class Work>
double seconds_of_block(const Work& work) {
  constexpr int calls = 5;
  const auto start = Clock::now();
  for (int i = 0; i < calls; ++i) work();
  return std::chrono::duration<double>(Clock::now() - start).count() / calls;
}

/// Smallest seconds of a call of each, measured in turns so that busy neighbours meet both alike.
template <class First, class Second>
std::pair<double, double> seconds_of(const First& first, const Second& second, double budget_s) {
  const auto begin = Clock::now();
  std::pair<double, double> best{1e30, 1e30};
  while (std::chrono::duration<double>(Clock::now() - begin).count() < budget_s) {
    best.first = std::min(best.first, seconds_of_block(first));
    best.second = std::min(best.second, seconds_of_block(second));
  }
  return best;
}

nlohmann::json measure(const Shape& shape, Sgemm sgemm, double budget_s) {
  const elrom::torch::OneFastThread guard;
  networks::TrainingProblem problem;
  const int n_records = 16 * shape.batch;
  problem.train_inputs = MatrixF::Random(n_records, shape.n_inputs);
  problem.train_targets = MatrixF::Random(n_records, shape.n_outputs);
  const networks::Hyperparameters hyperparameters{
      .learning_rate = 1e-4, .n_layers = shape.n_layers, .n_units = shape.n_units, .batch_size = shape.batch};
  elrom::torch::Training training(problem, hyperparameters, base::Seed(1), {});
  std::vector<std::int64_t> order(static_cast<std::size_t>(n_records));
  std::iota(order.begin(), order.end(), 0);
  base::Random(base::Seed(2)).shuffle(order);
  std::size_t at = 0;
  const auto batch = static_cast<std::size_t>(shape.batch);
  auto products = products_of(shape);
  const auto step = [&] {
    training.step(std::span(order).subspan(at, batch));
    at = (at + batch) % order.size();
  };
  const auto sgemm_alone = [&] {
    for (auto& product : products) product.run(sgemm);
  };
  const auto [step_s, sgemm_s] = seconds_of(step, sgemm_alone, budget_s);
  double flops = 0;
  for (const auto& product : products) flops += product.flops();
  return {{"inputs", shape.n_inputs},
          {"layers", shape.n_layers},
          {"units", shape.n_units},
          {"outputs", shape.n_outputs},
          {"batch", shape.batch},
          {"step_us", step_s * 1e6},
          {"sgemm_us", sgemm_s * 1e6},
          {"gflops", flops / sgemm_s * 1e-9},
          {"fraction_of_sgemm", sgemm_s / step_s}};
}

int run(bool small, const std::string& json_file) {
  const Sgemm sgemm = find_sgemm();
  // A whole field and a band of it, at the corners and the middle of the default search space.
  const std::vector<Shape> shapes{{39, 2, 64, 840, 64},  {39, 2, 128, 840, 128}, {39, 3, 256, 840, 256},
                                  {39, 2, 128, 200, 64}, {39, 2, 256, 200, 128}, {39, 1, 64, 200, 128}};
  nlohmann::json rows = nlohmann::json::array();
  double lowest = 1e30;
  fmt::print("{:>7} {:>6} {:>6} {:>8} {:>6} {:>10} {:>10} {:>8} {:>9}\n", "inputs", "layers", "units",
             "outputs", "batch", "step us", "sgemm us", "GFLOP/s", "fraction");
  for (const auto& shape : shapes) {
    rows.push_back(measure(shape, sgemm, small ? 1.0 : 5.0));
    const auto& row = rows.back();
    fmt::print("{:>7} {:>6} {:>6} {:>8} {:>6} {:>10.1f} {:>10.1f} {:>8.1f} {:>9.2f}\n", shape.n_inputs,
               shape.n_layers, shape.n_units, shape.n_outputs, shape.batch, row["step_us"].get<double>(),
               row["sgemm_us"].get<double>(), row["gflops"].get<double>(),
               row["fraction_of_sgemm"].get<double>());
    lowest = std::min(lowest, row["fraction_of_sgemm"].get<double>());
  }
  fmt::print("lowest fraction of sgemm: {:.2f}\n", lowest);
  if (!json_file.empty())
    base::write_text(json_file,
                     nlohmann::json{{"fraction_of_sgemm", lowest}, {"shapes", rows}}.dump(2) + "\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return base::run_app("bench-step", [&] {
    benchmark::CommandLine line("One training step against sgemm at its own shapes (one thread)");
    bool small = false;
    std::string json;
    line.add("--small", small, "shorter measurements: ends within a minute");
    line.add("--json", json, "write the figures to this file");
    if (const auto status = line.parse(argc, argv)) return *status;
    return run(small, json);
  });
}
