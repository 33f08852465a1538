#include "elrom/ingest/watch.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/case_files.hpp"

namespace elrom::ingest {
namespace {

namespace fs = std::filesystem;

bool is_cases_table(const fs::path& path) {
  if (path.extension() != ".csv") return false;
  try {
    (void)field::read_schema(path);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// Neither hidden, as files in the making are, nor a reason that we wrote.
bool is_a_users(const fs::path& path) {
  const auto name = path.filename().string();
  return !name.starts_with('.') && !name.ends_with(".reason.txt");
}

bool is_text(const fs::path& path) { return !fs::is_directory(path) && !is_hdf5(path); }

/// By its name: what a solver may export.
bool may_be_case(const fs::directory_entry& entry) {
  const auto name = entry.path().filename().string();
  if (!is_a_users(entry.path())) return false;
  if (entry.is_directory()) return fs::is_directory(entry.path() / "constant" / "polyMesh");
  constexpr std::array<std::string_view, 8> endings{".h5",  ".hdf5", ".hdf", ".txt",
                                                    ".csv", ".dat",  ".asc", ".gz"};
  const auto ends = [&](std::string_view ending) { return name.ends_with(ending); };
  return entry.is_regular_file() && std::any_of(endings.begin(), endings.end(), ends);
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return !b.empty() && fs::equivalent(a, b, ignored);
}

/// A name that is free in the folder: "a.h5", "a-2.h5" ...
fs::path free_place(const fs::path& folder, const fs::path& name) {
  auto place = folder / name;
  for (int i = 2; fs::exists(place); ++i)
    place = folder / (name.stem().string() + "-" + std::to_string(i) + name.extension().string());
  return place;
}

void move_over(const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::rename(from, to, failure);
  if (!failure) return;
  fs::copy(from, to, fs::copy_options::recursive);  // to another file system
  fs::remove_all(from);
}

}  // namespace

Watcher::Watcher(WatchOptions options) : options_(std::move(options)) {
  if (!fs::is_directory(options_.folder))
    throw InputError({.what = "no folder to watch", .where = options_.folder.string()});
  if (options_.refused.empty()) options_.refused = options_.folder / "refused";
  if (!fs::exists(options_.import.store) && options_.import.mesh.empty())
    throw UsageError({.what = "a new store needs a reduced mesh",
                      .where = options_.import.store.string(),
                      .advice = "give it by --mesh"});
}

Watcher::State Watcher::state_of(const fs::path& path) {
  if (!fs::is_directory(path)) return {fs::file_size(path), fs::last_write_time(path)};
  State state{0, fs::last_write_time(path)};
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) state.size += entry.file_size();
    state.changed = std::max(state.changed, entry.last_write_time());
  }
  return state;
}

bool Watcher::is_ours(const fs::path& path) const {
  const auto& import = options_.import;
  const std::array ours{import.store, import.mesh, import.cases, import.furnace, options_.refused};
  return std::ranges::any_of(ours, [&](const fs::path& one) { return is_same_file(path, one); });
}

/// @param others gets what is no case by its name
Watcher::States Watcher::list(std::vector<fs::path>& others) const {
  States states;
  for (const auto& entry : fs::directory_iterator(options_.folder)) {
    const auto& path = entry.path();
    if (is_ours(path)) continue;
    if (!may_be_case(entry)) {
      if (entry.is_regular_file() && is_a_users(path)) others.push_back(path);
      continue;
    }
    try {
      states[path] = state_of(path);
    } catch (const fs::filesystem_error&) {
      // Gone, or its parts are, while we looked.
    }
  }
  return states;
}

void Watcher::read_store() {
  in_store_.clear();
  if (!fs::exists(options_.import.store)) return;
  const auto store = field::SnapshotStore::open(options_.import.store);
  for (const auto& one : store.cases()) in_store_.insert(one.source_digest);
}

/// Files that have not changed since the last look, and that the store does not know.
/// @param others gets what is no case by its first line
std::vector<fs::path> Watcher::finished(const States& now, std::vector<fs::path>& others) {
  std::vector<fs::path> still;
  for (const auto& [path, state] : now) {
    const auto known = settled_.find(path), last = before_.find(path);
    if (known != settled_.end() && known->second == state) continue;
    if (last != before_.end() && last->second == state) still.push_back(path);
  }
  if (still.empty()) return still;
  read_store();
  std::erase_if(still, [&](const fs::path& path) {
    const bool is_note = is_text(path) && !begins_like_cells(path);
    if (is_note && !is_cases_table(path)) others.push_back(path);
    const bool is_done = is_note || in_store_.contains(case_digest(path));
    if (is_done) settled_[path] = now.at(path);
    return is_done;
  });
  return still;
}

Refusal Watcher::put_aside(const Refusal& refusal, Log& log) const {
  try {
    fs::create_directories(options_.refused);
    const auto place = free_place(options_.refused, refusal.file.filename());
    base::write_text(place.string() + ".reason.txt", refusal.reason + "\n");
    move_over(refusal.file, place);
  } catch (const std::exception& failure) {
    log.warning("cannot put " + refusal.file.string() + " aside: " + failure.what());
  }
  return refusal;
}

Look Watcher::look(Log& log, const std::stop_token& stop) {
  std::vector<fs::path> others;
  const auto now = list(others);
  Look result;
  for (const auto& [path, state] : now) {
    const auto last = before_.find(path);
    if (!settled_.contains(path) && (last == before_.end() || last->second != state)) ++result.n_unfinished;
  }
  const auto files = finished(now, others);
  std::ranges::copy_if(others, std::back_inserter(result.left_alone),
                       [&](const fs::path& path) { return told_.insert(path).second; });
  before_ = now;
  if (files.empty()) return result;
  if (options_.before_import) options_.before_import();
  auto import = options_.import;
  import.files = files;
  std::vector<Refusal> refused;
  const auto keep = [&](const fs::path& file, const std::string& reason) {
    refused.push_back({file, reason});
  };
  import.refused = keep;
  const auto summary = import_checked(import, {Policy::drop, options_.accepted}, log, stop);
  result.added = summary.added;
  result.n_cases = summary.n_cases;
  for (const auto& path : files) settled_[path] = now.at(path);
  for (const auto& refusal : refused) result.refused.push_back(put_aside(refusal, log));
  return result;
}

}  // namespace elrom::ingest
