#pragma once
// The methods that a study's settings ask for, each made once. Internal to the study.

#include "elrom/study/study.hpp"

namespace elrom::study {

class MethodSet {
 public:
  /// @throws NotBuiltError when the settings name a method that needs a trainer and there is none
  MethodSet(const Settings& settings, Toolbox toolbox, const io::StageCache* cache,
            networks::TrialStore* trials);

  /// @throws UsageError for an unknown name
  [[nodiscard]] const methods::Method& get(const std::string& name);
  /// Without a trainer it can screen, no more.
  [[nodiscard]] methods::NetworksMethod& networks();
  /// What "auto" chooses among.
  [[nodiscard]] std::vector<const methods::Method*> candidates();
  /// Methods to write bundles of: the model's own first, then the peers.
  [[nodiscard]] std::vector<std::string> bundles() const;
  /// Of the settings' peers those that this build can train.
  [[nodiscard]] std::vector<std::string> peers() const;
  /// Whether networks take part in this method.
  [[nodiscard]] bool trains_networks(const std::string& name) const;
  [[nodiscard]] bool is_peer(const std::string& name) const;
  /// The method itself, or for "auto" what it chooses among.
  [[nodiscard]] std::vector<const methods::Method*> candidates_of(const std::string& name);

 private:
  [[nodiscard]] std::unique_ptr<methods::Method> make(const std::string& name) const;
  [[nodiscard]] bool has_networks() const { return toolbox_.trainer != nullptr; }

  const Settings& settings_;
  Toolbox toolbox_;
  const io::StageCache* cache_;
  networks::TrialStore* trials_;
  std::map<std::string, std::unique_ptr<methods::Method>> made_;
};

}  // namespace elrom::study
