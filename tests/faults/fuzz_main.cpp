// libFuzzer's entry for one target, chosen when it is compiled (ELROM_FUZZ_TARGET). Beside what the
// sanitizers find, an input may not cost memory out of proportion; libFuzzer's -timeout=1 sees to its time.

#include <sanitizer/allocator_interface.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "fuzz_targets.hpp"

namespace {

// Twice an input's size, and what any input costs: a predictor's scratch memory, the JSON parser's.
constexpr std::size_t most_per_byte = 2, most_for_any = std::size_t{1} << 20;

thread_local std::size_t held = 0, most_held = 0;  // by the input at work

void on_malloc(const volatile void*, std::size_t size) {
  held += size;
  most_held = std::max(most_held, held);
}

void on_free(const volatile void* block) {
  if (block != nullptr) held -= std::min(held, __sanitizer_get_allocated_size(block));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool counting = __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free) != 0;
  static bool warm = false;  // what the first inputs leave behind (tables, catalogues) is not theirs
  held = most_held = 0;
  for (const auto& target : elrom::faults::fuzz_targets()) {
    if (target.name == ELROM_FUZZ_TARGET) target.run({data, size});
  }
  if (warm && counting && most_held > most_per_byte * size + most_for_any) {
    std::fprintf(stderr, "an input of %zu bytes cost %zu bytes of memory\n", size, most_held);
    std::abort();
  }
  warm = true;
  return 0;
}
