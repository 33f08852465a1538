#pragma once
// A master code: takes a model's runs from a repository, works on them and gives them back. What fails on the
// way is tried again, later and later and never in step with others (exponential backoff with full jitter);
// each write has a key, so that a try too many does nothing. While the model works its lease is renewed; who
// loses the lease all the same is told to stop, and gives nothing back.
//
// Thread rule: one thread.

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "elrom/base/error.hpp"
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
  double poll_s = 1;                   ///< between two looks when there is nothing to do
  double longest_wait_s = 30;          ///< between two tries
  std::vector<std::string> then = {};  ///< models that are asked for work on the same inputs after a run
  http::ClientOptions client = {};
};

/// A result that a run builds on.
struct SourceResult {
  std::int64_t id = 0;
  std::string model, version;
  std::string document;  ///< JSON
  std::string fields;    ///< a file of fields, kind elrom-prediction; empty: none
};

/// One run as it was given out.
struct Claimed {
  std::int64_t run = 0;
  std::string lease;
  std::string inputs;  ///< document: {"primary_air [kg/s]": 161.1, ...}, SI
  std::string inputs_digest = {};
  std::optional<double> load = {};  ///< fraction of full load
  std::vector<SourceResult> sources = {};
};

/// What a model made of it. A model that cannot throws: InputError and NumericalError end the run as failed,
/// WrongResultError as quarantined; what else it throws has it tried again.
struct Finished {
  std::string version, verdict, reason;
  std::string document;               ///< JSON
  std::string fields;                 ///< a file of fields, kind elrom-prediction; empty: none
  std::vector<std::string> ask = {};  ///< models that are to work on the same inputs next
};

/// What a run came to is wrong and reaches no model; people look at it.
class WrongResultError : public InputError {
  using InputError::InputError;
};

class Master {
 public:
  /// @param stop nobody wants the work any more: it is to end, by Interrupted or otherwise
  using Work = std::function<Finished(const Claimed&, const std::stop_token& stop)>;
  Master(MasterOptions options, Work work, Log& log);

  /// One run, if there is one. @return whether there was
  /// @throws Interrupted when `stop` comes before the repository answers; InputError for what it refuses
  bool work_once(const std::stop_token& stop);
  /// Until `stop`.
  void work(const std::stop_token& stop);

 private:
  [[nodiscard]] http::Response insist(const http::Request& request, const std::stop_token& stop);
  [[nodiscard]] http::Response expect(const std::string& target, const std::stop_token& stop);
  [[nodiscard]] std::optional<Claimed> claim(const std::stop_token& stop);
  [[nodiscard]] SourceResult fetch(std::int64_t result, const std::stop_token& stop);
  [[nodiscard]] http::Headers headers(const std::string& media) const;
  [[nodiscard]] std::string outcome_of(const Claimed& claimed, const std::stop_token& stop);
  [[nodiscard]] std::string send_fields(const std::string& file, const std::stop_token& stop);
  void return_unfinished(const Claimed& claimed);
  void give_back(const Claimed& claimed, const std::string& outcome, const std::stop_token& stop);

  MasterOptions options_;
  Work work_;
  Log& log_;
  http::Client client_;
};

struct PredictionWork {
  std::filesystem::path folder;              ///< for files on their way
  std::vector<std::string> outside{"el3d"};  ///< who is asked where the guard says outside
};

/// The work of elrom-predict: all fields with intervals by the bundle that is there now, and the guard's
/// verdict. Outside of what the bundle was trained on it gives no fields, and asks for the work of another.
[[nodiscard]] Master::Work prediction_work(ResidentModel& model, const PredictionWork& options);

}  // namespace elrom::serve
