#pragma once
// The work of elrom-build: takes the cases that simulations brought into the store of a study, and retrains
// it when enough of them are new. The gate says whether the new model answers.
//
// Thread rule: one thread at a time; the study's threads are used inside.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/serve/master.hpp"
#include "elrom/study/study.hpp"

namespace elrom::masters {

struct BuildOptions {
  std::filesystem::path study;        ///< with a model already
  std::size_t enough = 5;             ///< new cases in the store that make a training worth it
  std::vector<std::string> accepted;  ///< kinds of findings of the checks that are only told
  study::Toolbox toolbox;
  std::filesystem::path folder;  ///< for files on their way
};

/// A run's sources with fields are its cases; each is named by its model and inputs, and enters the store
/// once. A case that the checks refuse ends the run as quarantined.
[[nodiscard]] serve::Master::Work build_work(const BuildOptions& options, Log& log);

}  // namespace elrom::masters
