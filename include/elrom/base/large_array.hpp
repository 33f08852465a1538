#pragma once
// Memory for megabytes that are written once: not set to zero first, and in huge pages where the system gives
// them. A page fault costs some microseconds, and a case's nine fields alone are five hundred ordinary pages.

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace elrom::base {

/// For std::vector: elements made by resize() have no value until one is assigned.
template <class T>
class LargeArrayAllocator {
 public:
  using value_type = T;

  LargeArrayAllocator() = default;
  template <class U>
  explicit LargeArrayAllocator(const LargeArrayAllocator<U>& /*other*/) {}

  T* allocate(std::size_t n) {
    if (n * sizeof(T) < huge_page / 2)
      return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{alignment}));
    const std::size_t bytes = (n * sizeof(T) + huge_page - 1) / huge_page * huge_page;
    void* memory = ::operator new (bytes, std::align_val_t{huge_page});
    ::madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: where it is refused, ordinary pages do
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t n) {
    const std::size_t aligned = n * sizeof(T) < huge_page / 2 ? alignment : huge_page;
    ::operator delete (memory, std::align_val_t{aligned});
  }
  /// Default-initialised: a number is left as it is.
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
  template <class U>
  bool operator==(const LargeArrayAllocator<U>& /*other*/) const {
    return true;
  }

 private:
  static constexpr std::size_t alignment = 64, huge_page = std::size_t{2} << 20;
};

template <class T>
using LargeArray = std::vector<T, LargeArrayAllocator<T>>;

}  // namespace elrom::base
