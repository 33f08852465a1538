#pragma once
// Versions of a study's model, and the log of how each came and went.
//
//   STUDY/models/<n>.elrom   version n, from 1; never overwritten
//   STUDY/models/current     a link to the version that answers, replaced by rename
//   STUDY/model.elrom        a link to models/current, for whoever goes by this name
//   STUDY/models/log.json    every event, oldest first (data/FORMATS.md, kind "elrom-versions")
//
// An event is in the log before the link moves: whoever opens the versions next moves it to where the log
// says, so that a process that ends between the two loses nothing. A log that is lost begins anew with the
// versions that are there. A study that has a file `model.elrom`
// from before there were versions, or that somebody copied a bundle to, has it taken in as a version.
//
// Thread rule: one thread at a time; whatever changes something holds the study's lock (STUDY/.lock).

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace elrom::study {

struct VersionEvent {
  int number = 0;                  ///< of the version that it is about
  std::optional<int> parent = {};  ///< that was current before
  std::string by = {};             ///< "run", "fit", "retrain", "promote", "rollback", "taken in"
  bool promoted = false;           ///< the version became, or stayed, the current one
  std::string digest = {};         ///< of the bundle
  std::size_t n_cases = 0;         ///< trained on
  std::string date = {};           ///< as told (setting `date`); empty: not told
  std::string verdict = {};  ///< of the gate, JSON (gate.hpp); empty: nothing to compare with, or not asked
};

class Versions {
 public:
  /// Reads only. @throws InputError for a log of another kind, a newer major version or no valid JSON
  explicit Versions(std::filesystem::path study);
  /// Brings links, log and files in line (see above); for who holds the study's lock.
  void settle();

  /// Of the version that `current` names; nothing: there is none yet.
  [[nodiscard]] std::optional<int> current() const;
  [[nodiscard]] std::filesystem::path file(int number) const;
  /// One above all that were ever there.
  [[nodiscard]] int next() const;
  [[nodiscard]] std::vector<int> numbers() const;  ///< of the files, ascending
  /// The file of a version that must be there. @throws UsageError naming those that are
  [[nodiscard]] std::filesystem::path known(int number) const;

  [[nodiscard]] const std::vector<VersionEvent>& log() const { return events_; }
  /// The last event that judged or made the version; nullptr: the log does not know it.
  [[nodiscard]] const VersionEvent* last_of(int number) const;
  /// Whether the log's last word on a version is this: refused by the same verdict, beside the same present
  /// one.
  [[nodiscard]] bool is_known(const VersionEvent& event) const;
  /// There are versions and no log: settle() begins one anew with them.
  [[nodiscard]] bool has_lost_its_log() const;
  [[nodiscard]] std::string lost_log_sentence() const;
  /// Appends to the log and, where the event promotes, moves the link. Fills in parent, digest and n_cases.
  void record(VersionEvent event);
  /// What was current before the present one; going back twice goes back two. Nothing: it is the first.
  [[nodiscard]] std::optional<int> previous() const;

 private:
  [[nodiscard]] std::filesystem::path folder() const { return study_ / "models"; }
  [[nodiscard]] std::vector<int> promoted() const;
  void take_in();
  void begin_log();
  void write_log() const;
  void link_current(int number) const;

  std::filesystem::path study_;
  std::vector<VersionEvent> events_;
};

/// Makes a version answer, whatever the gate said; holds the study's lock. @return false: it does already
/// @throws UsageError when another process holds it, or naming the versions that are there
bool promote(const std::filesystem::path& study, int number, const std::string& date = {});

}  // namespace elrom::study
