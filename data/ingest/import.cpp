#include "elrom/ingest/import.hpp"

#include <algorithm>
#include <iterator>

#include "conform.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/ingest/case_files.hpp"
#include "elrom/ingest/cases_table.hpp"
#include "elrom/ingest/onto_mesh.hpp"

namespace elrom::ingest {

namespace {

// Who has other fields is told how to have them.
void expect_standard_fields(const CfdCase& first) {
  std::vector<std::string> names, others;
  for (const auto& info : first.fields) names.push_back(info.name);
  const auto standard = field::standard_fields();
  std::ranges::copy_if(names, std::back_inserter(others), [&](const std::string& name) {
    return std::ranges::find(standard, name, &field::FieldInfo::name) == standard.end();
  });
  for (const auto& info : standard) {
    if (std::ranges::find(names, info.name) != names.end()) continue;
    const auto near = base::closest_name(info.name, others);
    throw InputError({.what = "missing field '" + info.name + "'",
                      .where = first.record.source,
                      .found = names.empty() ? "no fields" : base::join(names, ", "),
                      .advice = (near ? "is '" + *near + "' meant? " : "") +
                                (names.empty() ? "a table's own fields need a unit: 'name [unit]'"
                                               : "or a store of these: --fields " + base::join(names, ","))});
  }
}

std::vector<field::FieldInfo> fields_of_new_store(const ImportOptions& options, const CfdCase& first) {
  if (options.fields.empty()) {
    expect_standard_fields(first);
    return {field::standard_fields().begin(), field::standard_fields().end()};
  }
  return field::choose_fields<InputError>(first.fields, options.fields, first.record.source);
}

// The furnace description that the user names, or that lies beside the mesh.
class FurnaceFile {
 public:
  FurnaceFile(const ImportOptions& options, Log& log) : is_named_(!options.furnace.empty()), log_(log) {
    path_ = options.furnace;
    if (!is_named_ && !options.mesh.empty()) {
      path_ = options.mesh;
      path_.replace_extension(".toml");
      if (!std::filesystem::exists(path_)) path_.clear();
    }
    if (!path_.empty()) furnace_ = field::read_furnace(path_);
  }

  /// What a store of these cases is to carry from now on; nothing: what it has.
  [[nodiscard]] std::optional<field::Furnace> use(const field::InputSchema& schema,
                                                  const std::optional<field::Furnace>& in_store) const {
    if (!furnace_) {
      if (!in_store)
        log_.info(
            "no furnace description, so no gas balance, mirrors or held-out cases; --furnace names one");
      return std::nullopt;
    }
    if (in_store && field::to_toml(*in_store) == field::to_toml(*furnace_)) return std::nullopt;
    if (in_store && !is_named_) {
      log_.warning("the store keeps its furnace description, which differs from " + path_.string() +
                   "; --furnace would replace it");
      return std::nullopt;
    }
    return fits(schema) ? furnace_ : std::nullopt;
  }

 private:
  // One that nobody named may be of other cases on the same mesh.
  [[nodiscard]] bool fits(const field::InputSchema& schema) const {
    try {
      field::expect_fits(*furnace_, schema, path_.string());
    } catch (const InputError& error) {
      if (is_named_) throw;
      log_.warning(std::string("furnace description not used: ") + error.what());
      return false;
    }
    log_.info("furnace description: " + path_.string());
    const auto flows = field::flows_without_opening(*furnace_, schema);
    if (!flows.empty())
      log_.warning("no opening of the furnace for " + base::join(flows, ", ") +
                   ": no balance of its gas flows counts them");
    return true;
  }

  bool is_named_;
  Log& log_;
  std::filesystem::path path_;
  std::optional<field::Furnace> furnace_;
};

class Import {
 public:
  Import(const ImportOptions& options, Log& log, const std::stop_token& stop)
      : options_(options),
        log_(log),
        stop_(stop),
        mesh_(mesh_of(options)),
        onto_mesh_(mesh_, options.n_threads, stop),
        furnace_file_(options, log) {
    if (!options.cases.empty()) table_ = read_cases_table(options.cases);
    if (!std::filesystem::exists(options.store)) return;
    const auto store = field::SnapshotStore::open(options.store);
    schema_ = store.schema();
    summary_.fields = store.fields();
    summary_.n_cases = store.n_cases();
    open_writer(store.furnace());
  }

  ImportSummary run() {
    for (std::size_t i = 0; i < options_.files.size(); ++i) {
      if (stop_.stop_requested()) throw Interrupted("import stopped; the store is as it was");
      take_or_refuse(options_.files[i]);
      log_.progress({.task = "import",
                     .done = static_cast<std::int64_t>(i + 1),
                     .total = static_cast<std::int64_t>(options_.files.size()),
                     .unit = "cases"});
    }
    if (options_.leave_out) leave_out(options_.leave_out());
    // A furnace alone makes no store, but a store may be given one.
    const bool describes_old = furnace_ && std::filesystem::exists(options_.store);
    if (writer_ && (!taken_.empty() || describes_old)) writer_->commit();
    sum_up();
    return summary_;
  }

 private:
  /// What the summary needs of a case that entered the store.
  struct Taken {
    std::string name;
    std::vector<double> error;
    std::size_t n_outside, n_cells;
  };

  static field::Mesh mesh_of(const ImportOptions& options) {
    if (!options.mesh.empty()) return field::read_mesh(options.mesh);
    if (std::filesystem::exists(options.store)) return field::SnapshotStore::open(options.store).mesh();
    throw UsageError({.what = "a new store needs a reduced mesh",
                      .where = options.store.string(),
                      .advice = "give it by --mesh, or make one by 'elrom-data mesh'"});
  }

  [[nodiscard]] const field::Furnace* furnace_now() const {
    return furnace_ ? &*furnace_ : in_store_ ? &*in_store_ : nullptr;
  }

  void open_writer(const std::optional<field::Furnace>& in_store) {
    in_store_ = in_store;
    furnace_ = furnace_file_.use(schema_, in_store);
    if (furnace_) summary_.fields = furnace_->limited(std::move(summary_.fields));
    writer_.emplace(options_.store, mesh_, schema_, summary_.fields, furnace_);
  }

  void take_or_refuse(const std::filesystem::path& file) {
    if (!options_.refused) return take(file);
    try {
      take(file);
    } catch (const InputError& error) {
      options_.refused(file, error.what());
    }
  }

  void take(const std::filesystem::path& file) {
    auto one = read_case(file);
    auto& record = one.record;
    if (record.source.empty()) record.source = std::filesystem::absolute(file).filename().string();
    if (record.source_digest.empty()) record.source_digest = case_digest(file);
    if (table_) complete_inputs(one, *table_);
    if (!writer_) {
      if (one.schema.size() == 0) {
        throw InputError({.what = "no boundary conditions",
                          .where = one.record.source,
                          .advice = "give them in a table by --cases"});
      }
      schema_ = one.schema;
      summary_.fields = fields_of_new_store(options_, one);
      (void)conform_fields(one, summary_.fields);  // a first case that lacks a field begins no file
      open_writer(std::nullopt);
    }
    const auto snapshot = onto_mesh_.bring(one, schema_, summary_.fields);
    writer_->add(snapshot);
    if (options_.watch)
      options_.watch({file, snapshot, mesh_, schema_, summary_.fields, furnace_now(), onto_mesh_.coverage()});
    taken_.push_back({snapshot.record.inputs.name, snapshot.record.resampling_error, onto_mesh_.n_outside(),
                      mesh_.n_cells()});
  }

  void leave_out(const std::set<std::string>& names) {
    if (names.empty()) return;
    writer_->leave_out(names);
    std::erase_if(taken_, [&](const Taken& one) { return names.contains(one.name); });
  }

  void sum_up() {
    for (const auto& one : taken_) summary_.added.push_back(one.name);
    summary_.n_cases += taken_.size();
    summary_.mean_error.assign(summary_.fields.size(), 0);
    summary_.largest_error.assign(summary_.fields.size(), 0);
    for (const auto& one : taken_) {
      for (std::size_t f = 0; f < summary_.fields.size(); ++f) {
        summary_.mean_error[f] += one.error[f] / static_cast<double>(taken_.size());
        summary_.largest_error[f] = std::max(summary_.largest_error[f], one.error[f]);
      }
      summary_.n_outside = one.n_outside;
      summary_.n_cells = one.n_cells;
    }
  }

  const ImportOptions& options_;
  Log& log_;
  std::stop_token stop_;
  field::Mesh mesh_;
  OntoMesh onto_mesh_;
  FurnaceFile furnace_file_;
  std::optional<CasesTable> table_;
  field::InputSchema schema_;
  std::optional<field::Furnace> in_store_;
  std::optional<field::Furnace> furnace_;  // that the store did not carry before
  std::optional<field::SnapshotWriter> writer_;
  std::vector<Taken> taken_;
  ImportSummary summary_;
};

}  // namespace

ImportSummary import_cases(const ImportOptions& options, Log& log, const std::stop_token& stop) {
  return Import(options, log, stop).run();
}

}  // namespace elrom::ingest
