#include "elrom/study/versions.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::study {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view ending = ".elrom";

/// 12 of "12.elrom"; nothing for any other name.
std::optional<int> number_of(const fs::path& file) {
  const auto stem = file.stem().string();
  const bool is_number = !stem.empty() && stem.size() < 9 && stem.front() != '0' &&
                         std::ranges::all_of(stem, [](char c) { return c >= '0' && c <= '9'; });
  if (file.extension() != ending || !is_number) return std::nullopt;
  return std::stoi(stem);
}

Json to_json(const VersionEvent& event) {
  Json json{{"number", event.number}, {"parent", event.parent ? Json(*event.parent) : Json()},
            {"by", event.by},         {"promoted", event.promoted},
            {"digest", event.digest}, {"cases", event.n_cases}};
  if (!event.date.empty()) json["date"] = event.date;
  json["verdict"] = event.verdict.empty() ? Json() : Json::parse(event.verdict);
  return json;
}

VersionEvent event_of(const Json& json) {
  VersionEvent event{.number = json.at("number"),
                     .by = json.at("by"),
                     .promoted = json.at("promoted"),
                     .digest = json.at("digest"),
                     .n_cases = json.at("cases"),
                     .date = json.value("date", "")};
  if (const auto verdict = json.value("verdict", Json()); !verdict.is_null()) event.verdict = verdict.dump();
  if (json.at("parent").is_number()) event.parent = json.at("parent").get<int>();
  return event;
}

std::vector<VersionEvent> read_log(const fs::path& file) {
  if (!fs::exists(file)) return {};
  try {
    const auto json = Json::parse(base::read_text(file));
    io::check_json_kind(json, io::kinds::versions, file.string());
    std::vector<VersionEvent> events;
    for (const auto& event : json.at("events")) events.push_back(event_of(event));
    return events;
  } catch (const Json::exception& fault) {
    throw InputError({.what = "no valid log of versions",
                      .where = file.string(),
                      .found = fault.what(),
                      .advice = "put it aside: a new one begins with the versions, which are all there"});
  }
}

/// A link whose target is replaced in one step.
void link_to(const fs::path& link, const fs::path& target) {
  std::error_code fault;
  if (fs::is_symlink(link) && fs::read_symlink(link, fault) == target) return;
  base::AtomicFile file(link);
  fs::create_symlink(target, file.temporary());
  file.commit();
}

std::string digest_of(const fs::path& bundle) { return model::BundleReader(bundle).digest(); }

}  // namespace

Versions::Versions(fs::path study)
    : study_(std::move(study)), events_(read_log(study_ / "models" / "log.json")) {}

fs::path Versions::file(int number) const {
  return folder() / (std::to_string(number) + std::string(ending));
}

std::vector<int> Versions::numbers() const {
  std::vector<int> found;
  std::error_code fault;
  for (const auto& entry : fs::directory_iterator(folder(), fault))
    if (const auto number = number_of(entry.path()); number && !entry.is_symlink()) found.push_back(*number);
  std::ranges::sort(found);
  return found;
}

int Versions::next() const {
  const auto there = numbers();
  int most = there.empty() ? 0 : there.back();
  for (const auto& event : events_) most = std::max(most, event.number);
  return most + 1;
}

std::optional<int> Versions::current() const {
  std::error_code fault;
  const auto target = fs::read_symlink(folder() / "current", fault);
  if (fault || !fs::exists(folder() / target)) return std::nullopt;
  return number_of(target);
}

fs::path Versions::known(int number) const {
  if (fs::exists(file(number))) return file(number);
  std::vector<std::string> names;
  for (const int one : numbers()) names.push_back(std::to_string(one));
  throw UsageError({.what = "no version " + std::to_string(number),
                    .where = study_.string(),
                    .advice = names.empty() ? "it has none yet" : "known are: " + base::join(names, ", ")});
}

const VersionEvent* Versions::last_of(int number) const {
  const VersionEvent* last = nullptr;
  for (const auto& event : events_)
    if (event.number == number && event.by != "promote" && event.by != "rollback") last = &event;
  return last;
}

/// Versions in the order in which they became current; a rollback takes the last away again.
std::vector<int> Versions::promoted() const {
  std::vector<int> order;
  for (const auto& event : events_) {
    if (!event.promoted) continue;
    if (event.by == "rollback") {
      if (!order.empty()) order.pop_back();
    } else if (order.empty() || order.back() != event.number) {
      order.push_back(event.number);
    }
  }
  return order;
}

std::optional<int> Versions::previous() const {
  const auto order = promoted();
  return order.size() < 2 ? std::nullopt : std::optional(order[order.size() - 2]);
}

void Versions::link_current(int number) const {
  link_to(folder() / "current", file(number).filename());
  link_to(study_ / "model.elrom", fs::path("models") / "current");
}

/// A plain file model.elrom becomes a version by a second name; its own stays until the link replaces it.
void Versions::take_in() {
  const auto plain = study_ / "model.elrom";
  if (!fs::is_regular_file(fs::symlink_status(plain))) return;
  fs::create_directories(folder());
  std::string digest;
  try {
    digest = digest_of(plain);
  } catch (const Error&) {
    fs::rename(plain, study_ / "model.elrom.unreadable");  // damaged, or not ours: nothing to go back to
    return;
  }
  for (const int number : numbers()) {
    if (digest_of(file(number)) != digest) continue;
    const bool told = !events_.empty() && events_.back().promoted && events_.back().number == number;
    told ? link_current(number) : record({.number = number, .by = "taken in", .promoted = true});
    return;
  }
  const int number = next();
  std::error_code fault;
  fs::create_hard_link(plain, file(number), fault);
  if (fault) {  // a file system without second names
    base::AtomicFile copy(file(number));
    fs::copy_file(plain, copy.temporary());
    copy.commit();
  }
  record({.number = number, .by = "taken in", .promoted = true});
}

bool Versions::has_lost_its_log() const { return events_.empty() && current(); }

std::string Versions::lost_log_sentence() const {
  return (folder() / "log.json").string() +
         " is missing: which version came when, and what the gate said, is not known any more";
}

bool Versions::is_known(const VersionEvent& event) const {
  const auto* last = last_of(event.number);
  const auto verdict_of = [](const VersionEvent& of) {
    return of.verdict.empty() ? Json() : Json::parse(of.verdict);
  };
  return last != nullptr && !last->promoted && !event.promoted && last->parent == current() &&
         verdict_of(*last) == verdict_of(event);
}

/// Versions that others came after have answered, and the present one answers.
void Versions::begin_log() {
  const auto present = current();
  if (!has_lost_its_log()) return;
  std::map<int, model::BundleInfo> found;
  std::set<std::string> parents;
  for (const int number : numbers()) {
    try {
      const auto& info = found.emplace(number, model::BundleReader(file(number)).info()).first->second;
      if (const auto parent = info.provenance.find("parent"); parent != info.provenance.end())
        parents.insert(parent->second);
    } catch (const InputError&) {
      // damaged: nothing can be told of it
    }
  }
  const auto add = [&](int number, bool promoted) {
    const auto& info = found.at(number);
    const auto date = info.provenance.find("date");
    events_.push_back({.number = number,
                       .by = "taken in",
                       .promoted = promoted,
                       .digest = digest_of(file(number)),
                       .n_cases = info.cases.size(),
                       .date = date == info.provenance.end() ? "" : date->second});
  };
  for (const auto& [number, info] : found)
    if (number != *present) add(number, parents.contains(digest_of(file(number))));
  if (found.contains(*present)) add(*present, true);
  write_log();
}

void Versions::settle() {
  for (const auto& target :
       {folder() / "current", folder() / "log.json", file(next()), study_ / "model.elrom"})
    base::remove_remains(target);
  begin_log();
  take_in();
  const auto order = promoted();
  if (!order.empty() && fs::exists(file(order.back()))) link_current(order.back());
}

void Versions::record(VersionEvent event) {
  const model::BundleReader bundle(known(event.number));
  event.parent = current();
  event.digest = bundle.digest();
  event.n_cases = bundle.info().cases.size();
  const int number = event.number;
  const bool moves = event.promoted;
  events_.push_back(std::move(event));
  write_log();
  if (moves) link_current(number);
}

void Versions::write_log() const {
  auto json = io::json_head<Json>(io::kinds::versions);
  json["events"] = Json::array();
  for (const auto& event : events_) json["events"].push_back(to_json(event));
  base::write_text(folder() / "log.json", json.dump(1) + "\n");
}

bool promote(const std::filesystem::path& study, int number, const std::string& date) {
  const base::FileLock lock(study / ".lock");
  Versions versions(study);
  versions.settle();
  const model::BundleReader bundle(versions.known(number));
  bundle.file().verify_all();
  if (versions.current() == number) return false;
  versions.record({.number = number, .by = "promote", .promoted = true, .date = date});
  return true;
}

}  // namespace elrom::study
