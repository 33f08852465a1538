#pragma once
// Methods that a report can fit anew on other cases of a study.

#include <memory>
#include <string>
#include <vector>

#include "elrom/methods/method.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::report {

/// Methods that need no search: the peers and the kernel.
[[nodiscard]] std::vector<std::string> refittable_methods();
/// The one of them that answers for most fields of a bundle; "kernel" where none does.
[[nodiscard]] std::string method_of(const model::BundleReader& bundle);
/// @throws UsageError for a method that cannot be fitted here, with those that can
[[nodiscard]] std::unique_ptr<methods::Method> make_method(const std::string& name);

}  // namespace elrom::report
