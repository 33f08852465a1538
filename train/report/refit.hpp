#pragma once
// Methods that a report can fit anew on other cases of a study.

#include <memory>
#include <string>

#include "elrom/model/bundle.hpp"
#include "elrom/report/study_files.hpp"
#include "elrom/study/method.hpp"

namespace elrom::report {

/// The method that answers for most fields of a bundle and can be fitted without the search: its kind, or
/// "pod_gp".
[[nodiscard]] std::string method_of(const model::BundleReader& bundle);
/// @param cases gets the mirrors of the study where the method uses them
/// @throws UsageError for a method that cannot be fitted here, with those that can
[[nodiscard]] std::unique_ptr<study::Method> make_method(const std::string& name, const StudyFiles& study,
                                                         study::CaseSet& cases);

}  // namespace elrom::report
