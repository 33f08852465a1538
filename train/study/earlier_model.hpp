#pragma once
// The model that a retraining starts from: what each field's fit may begin with, and which candidates need
// not be tried again. Internal to the study.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/methods/method.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::study {

/// A candidate that stays out this time, with what it reached when it was last fitted.
struct LeftOut {
  std::string name;
  double nrmse = 0;
  std::size_t n_cases = 0;  ///< that it was fitted with then
};

/// What an earlier model's study is compared with.
struct PresentStudy {
  std::vector<std::string> cases, case_digests;
  std::string settings_digest;  ///< of all that the model's candidates depend on beside the cases
};

class EarlierModel {
 public:
  /// @throws InputError when the bundle cannot be read
  explicit EarlierModel(const std::filesystem::path& bundle);

  /// Nothing is known of a field that the bundle lacks.
  [[nodiscard]] methods::WarmStart warm_start(const std::string& field) const;

  /// Rows of the present cases that a field's networks go on from (WarmStart::known): those that they were
  /// last planned and trained from nothing with. Empty where networks had no part in the contest, where one
  /// of those cases has left or changed, where settings have, or where there are more than `growth` times
  /// as many by now.
  [[nodiscard]] std::vector<std::size_t> known_rows(const std::string& field, const PresentStudy& now) const;

  /// Candidates of "auto" that stay out: no part of the earlier model, when they last competed with at least
  /// 1 / `growth` of the present cases.
  [[nodiscard]] std::vector<LeftOut> left_out(const std::string& field,
                                              const std::vector<const methods::Method*>& candidates,
                                              std::size_t n_cases) const;

  /// Eight cases more than 64 took at most a quarter off a candidate's distance to the winner (0.144 to 0.108
  /// of its error, POD + GP per mode, the shipped cases), so little is missed before the next contest.
  static constexpr double growth = 1.25;

 private:
  std::string digest_;
  model::BundleInfo info_;
  std::map<std::string, std::shared_ptr<const model::FieldModel>> models_;
};

}  // namespace elrom::study
