#pragma once
// Bundles as a fuzzer throws them, and the small good ones that it starts from.

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "elrom/model/bundle.hpp"
#include "fuzz_targets.hpp"

namespace elrom::faults {

/// One of every kind of model, by name; a few kilobytes each.
[[nodiscard]] std::map<std::string, model::Bundle> small_bundles();

/// The least that is taken for a bundle as long as no model is asked for: half a kilobyte, for quick fuzzing.
[[nodiscard]] io::TensorFile tiny_bundle();

/// A tensor file's bytes with the header's digest made true where there is room for
/// one: changed headers would all end there otherwise.
[[nodiscard]] std::vector<std::uint8_t> with_true_digest(Bytes input);

/// Takes numbers from the input, zeros when it is used up.
class Dice {
 public:
  explicit Dice(Bytes input) : input_(input) {}
  std::size_t below(std::size_t n);
  [[nodiscard]] bool used_up() const { return at_ >= input_.size(); }

 private:
  Bytes input_;
  std::size_t at_ = 0;
};

/// Changes texts and tensors as the input says, until it is used up.
void change(io::TensorFile& file, Dice& dice);

/// Numbers that arithmetic does not like.
inline constexpr float hard_numbers[] = {0.f,
                                         -1.f,
                                         1e38f,
                                         1e-42f,
                                         std::numeric_limits<float>::quiet_NaN(),
                                         std::numeric_limits<float>::infinity()};

void fuzz_bundle(Bytes input);
void fuzz_bundle_content(Bytes input);

}  // namespace elrom::faults
