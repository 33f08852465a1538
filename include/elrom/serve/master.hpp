#pragma once
// A master code: takes a model's runs from a repository, works on them and gives them back. What fails on the
// way is tried again, later and later and never in step with others (exponential backoff with full jitter);
// each write has a key, so that a try too many does nothing.
//
// Thread rule: one thread.

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "elrom/base/log.hpp"
#include "elrom/http/client.hpp"
#include "elrom/serve/resident_model.hpp"

namespace elrom::serve {

struct MasterOptions {
  std::string url;    ///< of the repository: "http://host:port"
  std::string token;  ///< of the role model
  std::string model;  ///< whose runs: "elrom"
  std::string worker = "master";
  double lease_s = 60;
  double poll_s = 1;           ///< between two looks when there is nothing to do
  double longest_wait_s = 30;  ///< between two tries
  http::ClientOptions client = {};
};

/// One run as it was given out.
struct Claimed {
  std::int64_t run = 0;
  std::string lease;
  std::string inputs;  ///< document: {"primary_air [kg/s]": 161.1, ...}, SI
};

/// What a model made of it. A model that cannot throws: InputError and NumericalError end the run as
/// failed, what else it throws has it tried again.
struct Finished {
  std::string version, verdict, reason;
  std::string document;  ///< JSON
  std::string fields;    ///< a file of fields, kind elrom-prediction; empty: none
};

class Master {
 public:
  using Work = std::function<Finished(const Claimed&)>;
  Master(MasterOptions options, Work work, Log& log);

  /// One run, if there is one. @return whether there was
  /// @throws Interrupted when `stop` comes before the repository answers; InputError for what it refuses
  bool work_once(const std::stop_token& stop);
  /// Until `stop`.
  void work(const std::stop_token& stop);

 private:
  [[nodiscard]] http::Response insist(const http::Request& request, const std::stop_token& stop);
  [[nodiscard]] std::optional<Claimed> claim(const std::stop_token& stop);
  [[nodiscard]] http::Headers headers(const std::string& media) const;
  void give_back(const Claimed& claimed, const std::string& outcome, const std::stop_token& stop);

  MasterOptions options_;
  Work work_;
  Log& log_;
  http::Client client_;
};

/// The work of elrom-predict: all fields with intervals by the bundle that is there now, and the guard's
/// verdict.
/// @param folder for files on their way
[[nodiscard]] Master::Work prediction_work(ResidentModel& model, const std::filesystem::path& folder);

}  // namespace elrom::serve
