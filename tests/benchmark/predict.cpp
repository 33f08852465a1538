// bench-predict: what a prediction costs, beside the floor of
// this machine and beside the same networks in LibTorch.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "elrom/base/app.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/model/banded_networks.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/predictor.hpp"
#include "predict_floor.hpp"
#include "processes.hpp"
#include "support/benchmark.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::benchmark {
namespace {

struct Options {
  bool small = false;
  int repeats = 40;
  std::string json, bundle, cases;
  std::filesystem::path programs;  ///< folder of elrom-predict
};

/// A bundle with a cases file of one case and one of a thousand.
struct Setup {
  std::filesystem::path bundle, one_case, table, output;
  int n_table = 0;
};

void write_cases(const std::filesystem::path& path, const model::BundleReader& bundle, int n) {
  std::ofstream file(path);
  file << "case";
  for (const auto& input : bundle.info().schema.inputs())
    file << "," << input.name << " [" << input.unit << "]";
  const auto guard = bundle.file().tensor("guard/inputs").matrix64();
  for (int k = 0; k < n; ++k) {
    // Mixtures of two training cases: inside the trained range whatever the bundle is.
    const auto a = guard.row(k % guard.rows()), b = guard.row((k * 7 + 1) % guard.rows());
    file << "\ncase_" << k;
    for (Eigen::Index i = 0; i < guard.cols(); ++i) file << "," << fmt::format("{}", 0.6 * a[i] + 0.4 * b[i]);
  }
  file << "\n";
}

Setup make_setup(const std::filesystem::path& folder, const std::string& name,
                 const std::filesystem::path& bundle, int n_table) {
  Setup setup{bundle, folder / (name + "-one.csv"), folder / (name + "-table.csv"), folder / (name + "-out"),
              n_table};
  const model::BundleReader reader(bundle);
  write_cases(setup.one_case, reader, 1);
  write_cases(setup.table, reader, n_table);
  return setup;
}

/// The source's size: nine fields, 26 inputs, 66 planes of 840 columns; four submodels a field of three
/// hidden layers.
std::filesystem::path sample(const std::filesystem::path& folder, const std::string& name,
                             std::size_t n_builds, bool half) {
  const test::BundleSize size{.n_x = 20,
                              .n_y = 42,
                              .n_planes = 66,
                              .n_inputs = 26,
                              .n_cases = 64,
                              .n_submodels = 4,
                              .n_builds = n_builds,
                              .n_layers = 3,
                              .n_units = 128,
                              .half_precision = half,
                              .with_uncertainty = false};
  auto path = folder / (name + ".elrom");
  test::sample_bundle(size).write(path);
  return path;
}

class Benchmark {
 public:
  explicit Benchmark(Options options) : options_(std::move(options)), n_threads_(base::available_threads()) {}

  nlohmann::json run() {
    const bool given = !options_.bundle.empty();
    const auto bundle =
        given ? std::filesystem::path(options_.bundle) : sample(folder_.path(), "networks", 1, false);
    const auto setup = make_setup(folder_.path(), "main", bundle, options_.small ? 100 : 1000);
    fmt::print("{} threads; whole processes, warm page cache, {} repeats; milliseconds: min, median\n",
               n_threads_, options_.repeats);
    one_shot(setup);
    parts(setup);
    neighbour(setup);
    table(setup);
    libtorch(setup);
    if (!given) variants();
    return result_;
  }

 private:
  std::vector<std::string> command(const Setup& setup, std::vector<std::string> more = {}) const {
    std::vector<std::string> words{(options_.programs / "elrom-predict").string(),
                                   "--bundle",
                                   setup.bundle.string(),
                                   "--cases",
                                   setup.one_case.string(),
                                   "--output",
                                   setup.output.string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  Timings show(const std::string& what, const std::vector<std::string>& words, int repeats) {
    const auto timings = time_process(words, repeats);
    fmt::print("{:<44}{:>9.2f}{:>9.2f}\n", what, timings.min_ms, timings.median_ms);
    return timings;
  }

  void one_shot(const Setup& setup) {
    const auto timings = show("one case, nine fields, file on the disk", command(setup), options_.repeats);
    const Floor floor = show_floor(setup, timings, true);
    const auto cached =
        show("the same, not waiting for the disk", command(setup, {"--no-sync"}), options_.repeats);
    const Floor cached_floor = show_floor(setup, cached, false);
    one_shot_ = timings;
    result_["one_shot_no_sync_ms"] = cached.median_ms;
    result_["ratio_to_floor_no_sync"] = cached.min_ms / cached_floor.total_ms();
    result_["one_shot_ms"] = timings.median_ms;
    result_["one_shot_min_ms"] = timings.min_ms;
    result_["floor_ms"] = floor.total_ms();
    // The floor is made of best rates, so the best run is what compares with it.
    result_["ratio_to_floor"] = timings.min_ms / floor.total_ms();
    result_["ratio_to_floor_median"] = timings.median_ms / floor.total_ms();
    result_["floor"] = floor.json();
  }

  Floor show_floor(const Setup& setup, const Timings& timings, bool sync) const {
    const Floor floor = floor_of(setup.bundle, setup.output, n_threads_, sync);
    fmt::print("{}\n{:<44}{:>9.2f}{:>9.2f}\n", floor.text(), "ratio to the floor",
               timings.min_ms / floor.total_ms(), timings.median_ms / floor.total_ms());
    return floor;
  }

  void parts(const Setup& setup) {
    const model::BundleReader bundle(setup.bundle);
    const auto& field = bundle.info().fields.front().name;
    result_["one_field_ms"] =
        show("one field", command(setup, {"--fields", field}), options_.repeats).median_ms;
    result_["one_plane_ms"] =
        show("one plane of all fields", command(setup, {"--planes", "0"}), options_.repeats).median_ms;
    result_["profile_ms"] =
        show("plane averages of all fields", command(setup, {"--profile"}), options_.repeats).median_ms;
    result_["no_verify_ms"] =
        show("without comparing digests", command(setup, {"--no-verify"}), options_.repeats).median_ms;
    result_["one_thread_ms"] =
        show("one thread", command(setup, {"--threads", "1"}), options_.repeats).median_ms;
    result_["two_threads_ms"] =
        show("two threads", command(setup, {"--threads", "2"}), options_.repeats).median_ms;
  }

  void neighbour(const Setup& setup) {
    const auto alone = time_process(command(setup), options_.repeats);
    const BusyNeighbour busy;
    const auto beside = show("beside a busy neighbour", command(setup), options_.repeats);
    result_["busy_neighbour_ms"] = beside.median_ms;
    result_["busy_neighbour_ratio"] = beside.median_ms / alone.median_ms;
    fmt::print("{:<44}{:>9.2f}\n", "ratio to the same alone (medians)", beside.median_ms / alone.median_ms);
  }

  void table(const Setup& setup) {
    auto words = command(setup);
    words[4] = setup.table.string();
    const auto timings = time_process(words, 1);
    result_["table_cases"] = setup.n_table;
    result_["table_cases_per_second"] = setup.n_table / timings.min_ms * 1e3;
    result_["table_peak_mib"] = timings.peak_mib;
    fmt::print("{} cases: {:.0f} cases/s, {:.0f} MiB resident at most\n", setup.n_table,
               setup.n_table / timings.min_ms * 1e3, timings.peak_mib);
    std::filesystem::remove_all(setup.output);
  }

  static bool is_networks(const std::filesystem::path& bundle) {
    const model::BundleReader reader(bundle);
    return std::ranges::all_of(reader.info().fields, [&](const field::FieldInfo& info) {
      return dynamic_cast<const model::BandedNetworks*>(reader.model(info.name).get()) != nullptr;
    });
  }

  void libtorch(const Setup& setup) {
    const auto program = options_.programs / "bench-libtorch-one-shot";
    result_["libtorch_one_shot_ms"] = nullptr;
    result_["ratio_to_libtorch"] = nullptr;
    if (!std::filesystem::exists(program)) {
      fmt::print("the same networks in LibTorch: not built (ELROM_TORCH is off)\n");
      return;
    }
    if (!is_networks(setup.bundle)) {
      fmt::print("the same networks in LibTorch: left out, other models answer for some fields\n");
      return;
    }
    std::filesystem::create_directories(setup.output);
    const auto timings = show("the same networks in LibTorch, one shot",
                              {program.string(), "--bundle", setup.bundle.string(), "--cases",
                               setup.one_case.string(), "--output", (setup.output / "libtorch.raw").string()},
                              options_.small ? 3 : 7);
    result_["libtorch_one_shot_ms"] = timings.median_ms;
    result_["ratio_to_libtorch"] = timings.median_ms / one_shot_.median_ms;
    fmt::print("{:<44}{:>9.1f}\n", "ratio (medians)", timings.median_ms / one_shot_.median_ms);
  }

  /// Five builds averaged, and the same in half precision, whose error is stated.
  void variants() {
    const auto full = make_setup(folder_.path(), "five", sample(folder_.path(), "five", 5, false), 1);
    const auto half =
        make_setup(folder_.path(), "five-half", sample(folder_.path(), "five-half", 5, true), 1);
    result_["mean_of_five_ms"] = show("mean of five builds", command(full), options_.repeats).median_ms;
    result_["mean_of_five_floor_ms"] = floor_of(full.bundle, full.output, n_threads_, true).total_ms();
    result_["best_of_five_ms"] =
        show("best of five builds (--builds best)", command(full, {"--builds", "best"}), options_.repeats)
            .median_ms;
    result_["mean_of_five_half_ms"] =
        show("mean of five builds, half precision", command(half), options_.repeats).median_ms;
    const double error = relative_difference(full, half);
    result_["half_precision_error"] = error;
    fmt::print("half precision changes the fields by {:.1e} of their spread (root mean square)\n", error);
  }

  /// Root mean square over fields of |a - b| relative to a's own standard deviation over cells.
  static double relative_difference(const Setup& a, const Setup& b) {
    const model::Predictor first(a.bundle), second(b.bundle);
    const auto inputs = field::read_cases(a.one_case, first.bundle().info().schema).front().values;
    std::vector<float> x(first.size()), y(second.size());
    model::Predictor::Scratch scratch;
    first.predict(inputs, x, {}, scratch);
    second.predict(inputs, y, {}, scratch);
    const auto n_fields = static_cast<Eigen::Index>(first.fields().size()),
               n = static_cast<Eigen::Index>(x.size()) / n_fields;
    const MatrixD before = ConstMapF(x.data(), n_fields, n).cast<double>(),
                  after = ConstMapF(y.data(), n_fields, n).cast<double>();
    double sum = 0;
    for (Eigen::Index f = 0; f < n_fields; ++f) {
      const double spread = (before.row(f).array() - before.row(f).mean()).square().sum();
      sum += (before.row(f) - after.row(f)).squaredNorm() / spread;
    }
    return std::sqrt(sum / static_cast<double>(n_fields));
  }

  Options options_;
  int n_threads_;
  test::TemporaryFolder folder_;
  Timings one_shot_;
  nlohmann::json result_;
};

int run(int argc, char** argv) {
  Options options;
  CommandLine line(
      "Measures elrom-predict: one shot against its floor and LibTorch, parts, a table, a busy neighbour.");
  line.add("--small", options.small, "fewer repeats, a shorter table: ends within a minute");
  line.add("--json", options.json, "file for the figures");
  line.add("--bundle", options.bundle, "measure this bundle; default: random networks of the source's size");
  if (const auto status = line.parse(argc, argv)) return *status;
  if (options.small) options.repeats = 12;
  options.programs = std::filesystem::canonical("/proc/self/exe").parent_path();
  const auto result = Benchmark(options).run();
  if (!options.json.empty()) std::ofstream(options.json) << result.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace elrom::benchmark

int main(int argc, char** argv) {
  return elrom::base::run_app("bench-predict", [&] { return elrom::benchmark::run(argc, argv); });
}
