#pragma once
// How import and watch are told what to do with cases that the checks object to.

#include <string>
#include <vector>

#include "elrom/cli/cli.hpp"
#include "elrom/ingest/import_checked.hpp"

namespace elrom::programs {

struct JudgementOptions {
  std::string policy = "refuse";
  std::vector<std::string> accepted;

  [[nodiscard]] ingest::Judgement read() const {
    return {ingest::policy_of(policy), ingest::accepted_kinds(accepted)};
  }
};

/// --accept CHECK,...
void add_accept(cli::App& command, JudgementOptions& options);
/// --on-suspicious and --accept
void add_judgement(cli::App& command, JudgementOptions& options);

}  // namespace elrom::programs
