#include <algorithm>

#include "campaign.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/particle/collision_set.hpp"
#include "process.hpp"

namespace elrom::faults {

void Tally::count(bool good, const std::string& failure) { count(std::size_t{good ? 1U : 0U}, 1, failure); }

void Tally::count(std::size_t n_good, std::size_t n, const std::string& failure) {
  of += n;
  passed += n_good;
  if (n_good < n && failures.size() < 10) failures.push_back(failure);
}

std::vector<std::string> Workshop::case_files(std::size_t n, std::size_t first) const {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(source / "data" / "cases")) {
    if (entry.path().filename().string().starts_with("train_")) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  if (files.size() < first + n) throw std::runtime_error("too few shipped cases");
  return {files.begin() + static_cast<std::ptrdiff_t>(first),
          files.begin() + static_cast<std::ptrdiff_t>(first + n)};
}

std::vector<std::string> Workshop::import_command(const std::filesystem::path& store,
                                                  const std::vector<std::string>& files) const {
  std::vector<std::string> command{program("elrom-data"), "import",  "--mesh",
                                   mesh().string(),       "--store", store.string()};
  command.insert(command.end(), files.begin(), files.end());
  return command;
}

void Workshop::make_study(const std::filesystem::path& study, std::size_t n_cases,
                          const std::string& settings) const {
  std::filesystem::create_directories(study);
  const auto exit = run(import_command(study / "snapshots.h5", case_files(n_cases)));
  if (exit.status != 0) throw std::runtime_error("cannot make a study: " + exit.output);
  base::write_text(study / "study.toml", settings);
}

std::vector<std::string> Workshop::train_command(const std::filesystem::path& study) const {
  return {program("elrom-train"), "run", study.string()};
}

std::vector<std::string> Workshop::predict_command(const std::filesystem::path& bundle,
                                                   const std::filesystem::path& output) const {
  return {program("elrom-predict"),
          "--bundle",
          bundle.string(),
          "--cases",
          (source / "data/cases/cases.csv").string(),
          "--output",
          output.string()};
}

std::vector<std::string> Workshop::collide_command(const std::filesystem::path& output,
                                                   std::size_t n_pairs) const {
  return {program("elrom-data"),
          "collisions",
          "--pairs",
          std::to_string(n_pairs),
          "--law",
          "hertz",
          "--friction",
          "0.3",
          "--steps-per-contact",
          "100",
          "--output",
          output.string()};
}

bool collisions_whole(const std::filesystem::path& path) {
  try {
    if (std::filesystem::exists(path)) (void)particle::read_collisions(path);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

long store_state(const std::filesystem::path& store) {
  if (!std::filesystem::exists(store)) return -1;
  try {
    const auto opened = field::SnapshotStore::open(store);
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < opened.n_cases(); ++i) all.push_back(i);
    for (const auto& info : opened.fields()) (void)opened.read(info.name, all);
    return static_cast<long>(opened.n_cases());
  } catch (const std::exception&) {
    return -2;
  }
}

}  // namespace elrom::faults
