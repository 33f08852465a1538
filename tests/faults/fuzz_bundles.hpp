#pragma once
// Bundles as a fuzzer throws them, and the small good ones that it starts from.

#include <map>
#include <string>

#include "elrom/model/bundle.hpp"
#include "fuzz_targets.hpp"

namespace elrom::faults {

/// One of every kind of model, by name; a few kilobytes each.
[[nodiscard]] std::map<std::string, model::Bundle> small_bundles();

/// The least that is taken for a bundle as long as no model is asked for: half a kilobyte, for quick fuzzing.
[[nodiscard]] io::TensorFile tiny_bundle();

void fuzz_bundle(Bytes input);
void fuzz_bundle_content(Bytes input);

}  // namespace elrom::faults
