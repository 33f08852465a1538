#pragma once
// Which new case hurts: what each case alone does to the present model's error on cases that it has not seen,
// by giving it that case with all else kept (model::with_case). The present model's hyperparameters know no
// new case, so that a bad one cannot hide behind the noise that it brings. A closed form for the kernel
// smoother; a blend counts with the share that its smoother has in it, and fields that others predict alone
// are left out.
//
// Judged on the held-out cases as reports score them (scores.hpp); where there are none, on each of the
// present model's training cases by the model without it (leave-one-out).
//
// Thread rule: pure functions of files.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "elrom/study/gate.hpp"

namespace elrom::study {

struct CaseEffect {
  std::string name;
  double change = 0;  ///< mean over the fields of NRMSE with the case - NRMSE without it; above 0: it hurts
  std::map<std::string, double> fields = {};  ///< the same by field
};

struct CaseEffects {
  std::string judged_on = {};          ///< "held-out cases" | "leave-one-out"
  std::vector<CaseEffect> cases = {};  ///< the one that hurts most first; empty: no field has a closed form
  std::vector<std::string> left_out = {};  ///< fields whose models have no closed form
};

/// @param names of cases of the store that the present bundle was not trained on
/// @throws InputError for a bundle that cannot be read, or that does not fit the store
[[nodiscard]] CaseEffects effects_of(const std::vector<std::string>& names,
                                     const std::filesystem::path& present, const GateCases& cases,
                                     int n_threads);

/// {"judged_on", "no_closed_form": [...], "cases": [{"case", "change", "fields": {...}}]}
[[nodiscard]] std::string to_json(const CaseEffects& effects);
/// A line for each case that raises the error by more than `least`, and what could not be judged.
[[nodiscard]] std::string in_words(const CaseEffects& effects, double least);

}  // namespace elrom::study
