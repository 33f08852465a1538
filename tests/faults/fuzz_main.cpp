// libFuzzer's entry for one target, chosen when it is compiled (ELROM_FUZZ_TARGET).

#include <cstdlib>

#include "fuzz_targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const auto& target : elrom::faults::fuzz_targets()) {
    if (target.name == ELROM_FUZZ_TARGET) target.run({data, size});
  }
  return 0;
}
