// libFuzzer's entry for one target, chosen when it is compiled (ELROM_FUZZ_TARGET). Beside what the
// sanitizers find, an input may cost neither memory out of proportion nor more than a second of processor
// time; libFuzzer's own -timeout counts the time that other programs take, and is for inputs that never end.

#include <sanitizer/allocator_interface.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "fuzz_targets.hpp"

namespace {

// Twice an input's size, and what any input costs: a predictor's scratch memory, the JSON parser's, a
// table's buffer of 1 MiB.
constexpr std::size_t most_per_byte = 2, most_for_any = std::size_t{3} << 19;
constexpr double most_seconds = 1;

thread_local std::size_t held = 0, most_held = 0;  // by the input at work

void on_malloc(const volatile void*, std::size_t size) {
  held += size;
  most_held = std::max(most_held, held);
}

void on_free(const volatile void* block) {
  if (block != nullptr) held -= std::min(held, __sanitizer_get_allocated_size(block));
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool counting = __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free) != 0;
  static bool warm = false;  // what the first inputs leave behind (tables, catalogues) is not theirs
  held = most_held = 0;
  const double begin = processor_seconds();
  for (const auto& target : elrom::faults::fuzz_targets()) {
    if (target.name == ELROM_FUZZ_TARGET) target.run({data, size});
  }
  if (warm && counting && most_held > most_per_byte * size + most_for_any) {
    std::fprintf(stderr, "an input of %zu bytes cost %zu bytes of memory\n", size, most_held);
    std::abort();
  }
  if (const double seconds = processor_seconds() - begin; warm && seconds > most_seconds) {
    std::fprintf(stderr, "an input of %zu bytes cost %g seconds\n", size, seconds);
    std::abort();
  }
  warm = true;
  return 0;
}
