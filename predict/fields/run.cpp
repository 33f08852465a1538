#include "elrom/fields/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <memory>
#include <mutex>

#include "case_list.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/large_array.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/model/predictor.hpp"
#include "hdf_writer.hpp"
#include "physics.hpp"
#include "report_lines.hpp"
#include "text_writer.hpp"
#include "timing.hpp"

namespace elrom::fields {
namespace {

/// From this many cases on Ctrl-C is watched for; below, ending the process at once is clean enough (files
/// appear whole).
constexpr std::size_t long_table = 16;

const char* extension_of(Format format) {
  switch (format) {
    case Format::hdf:
      return ".hdf";
    case Format::csv:
      return ".csv";
    case Format::txt:
      return ".txt";
    case Format::ip:
      return ".ip";
  }
  return "";
}

void write_all(std::FILE* stream, const std::string& text, const std::string& where) {
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stream) == text.size() && std::fflush(stream) == 0;
  if (!written) throw SystemError({.what = "cannot write", .where = where, .advice = "is the disk full?"});
}

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  std::FILE* stream = std::fopen(path.c_str(), "wb");
  if (stream == nullptr) throw SystemError({.what = "cannot write", .where = path.string()});
  try {
    write_all(stream, text, path.string());
  } catch (...) {
    std::fclose(stream);
    throw;
  }
  if (std::fclose(stream) != 0)
    throw SystemError({.what = "cannot write", .where = path.string(), .advice = "is the disk full?"});
}

/// Bundles of format 1.0 may lack it: then the mesh itself is written.
std::optional<PackedGeometry> packed_geometry(const model::BundleReader& bundle) {
  const auto& file = bundle.file();
  if (!file.has("mesh/packed/points")) return std::nullopt;
  const auto part = [&](const char* name) { return file.tensor(std::string("mesh/packed/") + name); };
  return PackedGeometry{.centre = part("centre"),
                        .points = part("points"),
                        .connectivity = part("connectivity"),
                        .offsets = part("offsets"),
                        .types = part("types"),
                        .n_points = file.tensors().at("mesh/points").shape().at(0)};
}

/// What one thread needs for one case at a time; reused, so that a long table runs in flat memory.
struct Desk {
  model::Predictor::Scratch scratch;
  base::LargeArray<float> values, half_width;    //!< as predicted
  std::vector<float> chosen, chosen_half_width;  //!< after region and averages
  PhysicsResult physics;
  std::string text;
  double compute = 0, write = 0;
};

/// A prediction's file on its way: all of it but the values is
/// written first, and each field when it is ready.
class HdfFile {
 public:
  struct Begun {
    std::unique_ptr<base::AtomicFile> file;
    HdfWriter writer;
  };
  /// @param library guards the HDF5 library
  HdfFile(std::mutex& library, std::function<Begun()> make) : library_(library), make_(std::move(make)) {}
  ~HdfFile() {  // what an exception leaves open is closed by the library too
    const std::scoped_lock lock(library_);
    begun_.reset();
  }
  HdfFile(const HdfFile&) = delete;
  HdfFile& operator=(const HdfFile&) = delete;

  void begin() {
    const std::scoped_lock lock(library_);
    begun_.emplace(make_());
    is_begun_ = true;
  }
  /// Writes a field if the file has been begun; finish() writes it otherwise.
  void offer_field(const Prediction& prediction, std::size_t i) {
    if (!is_begun_) return;
    const std::scoped_lock lock(library_);
    begun_->writer.write_field(prediction, i);
    begun_->file->begin_sync();
  }
  void finish(const Prediction& prediction) {
    if (!is_begun_) begin();
    {
      const std::scoped_lock lock(library_);
      begun_->writer.finish(prediction);
    }
    begun_->file->commit();
  }

 private:
  std::mutex& library_;
  std::function<Begun()> make_;
  std::optional<Begun> begun_;
  std::atomic<bool> is_begun_{false};
};

/// The parts of a run that live as long as it.
class Session {
 public:
  explicit Session(const Arguments& arguments);
  int predict_all();

 private:
  void load_geometry(const model::BundleReader& bundle);
  void prepare();
  void predict_case(std::size_t i, Desk& desk, int n_threads);
  [[nodiscard]] std::span<const float> choose(std::span<const float> predicted, std::vector<float>& chosen,
                                              bool average) const;
  [[nodiscard]] std::unique_ptr<base::AtomicFile> file_for(Format format,
                                                           const field::CaseInputs& inputs) const;
  void write_text(Format format, const Prediction& prediction, Desk& desk);
  [[nodiscard]] std::filesystem::path target(Format format, const field::CaseInputs& inputs) const;

  const Arguments& arguments_;
  Stopwatch whole_, lap_;
  Timing timing_;
  double cached_ = 0;
  int n_threads_;
  std::vector<field::CaseInputs> cases_;
  std::optional<Physics> physics_;  ///< only with --audit or --conserve
  std::optional<model::Predictor> predictor_;
  Run run_;
  std::optional<ReportLines> lines_;
  std::mutex hdf5_;  //!< the library is not thread-safe
  std::atomic<std::size_t> n_outside_{0};
};

Session::Session(const Arguments& arguments)
    : arguments_(arguments),
      n_threads_(arguments.n_threads > 0 ? arguments.n_threads : base::available_threads()) {
  if (arguments_.timing) cached_ = cached_share(arguments_.bundle);
  lap_.lap();
  model::BundleReader bundle(arguments_.bundle, arguments_.verify ? io::Verify::on_use : io::Verify::never);
  cases_ = case_list(arguments_, bundle.info().schema);
  load_geometry(bundle);
  if (arguments_.audit || arguments_.conserve) physics_.emplace(arguments_, bundle, run_.cells);
  timing_.open = lap_.lap();
  model::Selection selection{.fields = arguments_.fields,
                             .planes = run_.cells.planes,
                             .best_build_only = arguments_.best_build_only,
                             .interval_level = arguments_.level,
                             .load_on_use = cases_.size() == 1 && !arguments_.timing,
                             .n_threads = n_threads_};
  predictor_.emplace(std::move(bundle), std::move(selection));
  timing_.read = lap_.lap();
  prepare();
  timing_.prepare = lap_.lap();
}

/// The mesh is read only where something of it has to be chosen, averaged or printed.
void Session::load_geometry(const model::BundleReader& bundle) {
  const bool everything = arguments_.planes.empty() && arguments_.region.empty() && !arguments_.profile;
  if (everything) run_.packed = packed_geometry(bundle);
  if (run_.packed && arguments_.formats == std::vector{Format::hdf}) {
    run_.cells = all_cells(bundle.n_planes(), bundle.n_columns());
    return;
  }
  const auto planes = parse_planes(arguments_.planes, bundle.n_planes());
  const auto box = arguments_.region.empty() ? std::nullopt : std::optional(parse_box(arguments_.region));
  const auto mesh = bundle.mesh({planes, !arguments_.profile, n_threads_});
  run_.cells = choose_cells(mesh, planes, box);
  if (arguments_.profile) {
    run_.average.emplace(mesh, run_.cells);
  } else {
    run_.geometry = geometry_of(mesh, run_.cells);
  }
}

void Session::prepare() {
  const auto& bundle = predictor_->bundle();
  run_.fields = predictor_->fields();
  run_.schema = bundle.info().schema;
  run_.level = arguments_.level;
  run_.bundle_digest = bundle.digest();
  run_.mesh_digest = bundle.mesh_digest();
  run_.bundle_program = bundle.file().text("program");
  run_.method = bundle.info().method;
  run_.best_build_only = arguments_.best_build_only;
  if (!arguments_.to_standard_output()) std::filesystem::create_directories(arguments_.output);
  lines_.emplace(cases_.size(), arguments_.to_standard_output() ? stderr : stdout);
}

std::filesystem::path Session::target(Format format, const field::CaseInputs& inputs) const {
  return std::filesystem::path(arguments_.output) / (inputs.name + extension_of(format));
}

/// Predicted planes -> what is written: cells of the region, or averages over planes.
std::span<const float> Session::choose(std::span<const float> predicted, std::vector<float>& chosen,
                                       bool average) const {
  const auto& sources = run_.cells.sources;
  if (predicted.empty() || (sources.empty() && !average)) return predicted;
  const std::size_t n_cells = run_.cells.size(), n_values = average ? run_.n_values() : n_cells;
  const std::size_t n_predicted = predicted.size() / run_.fields.size();
  chosen.resize(run_.fields.size() * n_values);
  std::vector<float> gathered(sources.size());
  for (std::size_t i = 0; i < run_.fields.size(); ++i) {
    auto field = predicted.subspan(i * n_predicted, n_predicted);
    for (std::size_t k = 0; k < sources.size(); ++k)
      gathered[k] = field[static_cast<std::size_t>(sources[k])];
    if (!sources.empty()) field = gathered;
    const auto out = std::span(chosen).subspan(i * n_values, n_values);
    if (average) {
      run_.average->apply(field, out);
    } else {
      std::copy(field.begin(), field.end(), out.begin());
    }
  }
  return chosen;
}

std::unique_ptr<base::AtomicFile> Session::file_for(Format format, const field::CaseInputs& inputs) const {
  return std::make_unique<base::AtomicFile>(target(format, inputs),
                                            arguments_.sync ? base::Sync::content : base::Sync::none);
}

void Session::write_text(Format format, const Prediction& prediction, Desk& desk) {
  desk.text.clear();
  if (format == Format::csv) write_csv(run_, prediction, desk.text);
  if (format == Format::txt) write_sfw3d(run_, prediction, desk.text);
  if (format == Format::ip) write_fluent(run_, prediction, desk.text);
  if (arguments_.to_standard_output()) {
    write_all(stdout, desk.text, "standard output");
    return;
  }
  const auto file = file_for(format, *prediction.inputs);
  write_text_file(file->temporary(), desk.text);
  file->commit();
}

void Session::predict_case(std::size_t i, Desk& desk, int n_threads) {
  Stopwatch lap;
  const auto& inputs = cases_[i];
  const auto assessment = predictor_->guard().assess(inputs.values);
  std::string line =
      fmt::format("{}: {}, {}", inputs.name, model::name_of(assessment.verdict), assessment.reason);
  const bool outside = assessment.verdict == model::Verdict::outside;
  if (outside) ++n_outside_;
  if (outside && arguments_.strict) {
    lines_->add(i, line + "; not written (--strict)");
    return;
  }
  // A single case: its file is written while it is predicted. In a table every thread has a case of its own.
  // With --timing one after the other, as what runs side by side has no time of its own.
  const bool at_once = n_threads > 1 && arguments_.writes(Format::hdf) && !arguments_.timing;
  HdfFile hdf(hdf5_, [&] {
    auto file = file_for(Format::hdf, inputs);
    const auto path = file->temporary();
    return HdfFile::Begun{std::move(file), HdfWriter(run_, inputs, assessment, path)};
  });
  desk.values.resize(predictor_->size());
  if (run_.level) desk.half_width.resize(predictor_->size());
  // As predicted is as written, unless something is still chosen, averaged or repaired.
  const bool as_predicted = !physics_ && run_.cells.sources.empty() && !run_.average;
  const Prediction predicted{
      .inputs = &inputs, .assessment = &assessment, .values = desk.values, .half_width = desk.half_width};
  model::Predictor::Alongside alongside;
  if (at_once) alongside.first = [&] { hdf.begin(); };
  if (at_once && as_predicted)
    alongside.ready = [&](std::size_t i_field) { hdf.offer_field(predicted, i_field); };
  predictor_->predict(inputs.values, desk.values, desk.half_width, desk.scratch, n_threads, alongside);
  if (physics_) desk.physics = physics_->apply(inputs, desk.values);
  const Prediction prediction{
      .inputs = &inputs,
      .assessment = &assessment,
      .values = choose(desk.values, desk.chosen, run_.average.has_value()),
      .half_width = choose(desk.half_width, desk.chosen_half_width, run_.average.has_value()),
      .audit = desk.physics.audit ? &*desk.physics.audit : nullptr,
      .change = desk.physics.change ? &*desk.physics.change : nullptr};
  desk.compute += lap.lap();
  for (const auto format : arguments_.formats) {
    if (format == Format::hdf) {
      hdf.finish(prediction);
    } else {
      write_text(format, prediction, desk);
    }
    if (!arguments_.to_standard_output()) line += " -> " + target(format, inputs).string();
  }
  desk.write += lap.lap();
  line += desk.physics.text();
  lines_->add(i, std::move(line));
}

int Session::predict_all() {
  // One case: its fields are shared out. A table: its cases are, each on one thread.
  const bool table = cases_.size() > 1;
  std::vector<Desk> desks(table ? static_cast<std::size_t>(n_threads_) : 1);
  if (table) {
    const auto stop = cases_.size() >= long_table ? base::interrupt_token() : std::stop_token();
    base::parallel_for(
        cases_.size(), n_threads_,
        [&](std::size_t i, int worker) { predict_case(i, desks[static_cast<std::size_t>(worker)], 1); },
        stop);
  } else {
    predict_case(0, desks[0], n_threads_);
  }
  for (const auto& desk : desks) {
    timing_.compute += desk.compute;
    timing_.write += desk.write;
  }
  timing_.wall = whole_.lap();
  if (arguments_.timing) {
    fmt::print(stderr, "{}\nbundle {:.0f} % in the page cache before ({}), {}\n", timing_.text(cases_.size()),
               100 * cached_, cached_ > 0.99 ? "warm" : "cold", page_faults());
  }
  if (n_outside_ > 0 && arguments_.strict) {
    throw ValidityError(fmt::format("{} of {} cases outside the trained range were not written",
                                    n_outside_.load(), cases_.size()));
  }
  return 0;
}

}  // namespace

int run(const Arguments& arguments) {
  if (arguments.level && !(*arguments.level > 0 && *arguments.level < 1)) {
    throw UsageError({.what = "--uncertainty",
                      .found = fmt::format("{}", *arguments.level),
                      .expected = "a level between 0 and 1"});
  }
  return Session(arguments).predict_all();
}

}  // namespace elrom::fields
