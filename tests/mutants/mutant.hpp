#pragma once
// Switches of tests/mutants/run: all faults of a room are compiled at once, and ELROM_MUTANT=number of one
// turns it on, in a program and in those that it starts. Which are reached is kept in the file
// ELROM_MUTANTS_REACHED, a byte each: what a program that was killed has reached stands in it too.
//
// An operator becomes two with a switch between them: a < b is a < Either<12, std::less_equal<>>{} < b. The
// same operator keeps precedence and grouping; what stands left of it waits for what stands right.

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <type_traits>

namespace elrom_mutants {

inline char* reached() {
  const char* path = std::getenv("ELROM_MUTANTS_REACHED");
  const int file = path != nullptr ? ::open(path, O_RDWR | O_CLOEXEC) : -1;
  struct stat status {};
  if (file < 0 || ::fstat(file, &status) != 0) return nullptr;
  void* bytes =
      ::mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  return bytes == MAP_FAILED ? nullptr : static_cast<char*>(bytes);
}

inline bool on(int number) {
  static char* const told = reached();
  if (told != nullptr) told[number] = 1;
  static const int chosen = [] {
    const char* text = std::getenv("ELROM_MUTANT");
    return text != nullptr ? std::atoi(text) : 0;
  }();
  return chosen == number;
}

/// One or two faults at an operator: mutant number First puts New in its place, First + 1 Other.
template <int First, class New, class Other = New>
struct Either {
  template <class Old, class A, class B>
  static auto apply(const A& a, const B& b) -> decltype(Old{}(a, b)) {
    if (on(First)) return New{}(a, b);
    if constexpr (!std::is_same_v<New, Other>)
      if (on(First + 1)) return Other{}(a, b);
    return Old{}(a, b);
  }
};

template <class A, class Switch, class Old>
struct Left {
  const A& a;
};
template <class B, class Switch, class Old>
struct Right {
  const B& b;
};

template <class T>
concept Number = std::is_arithmetic_v<T>;

#define ELROM_INFIX(SIGN, OLD, WHAT)                                                        \
  template <WHAT A, int K, class N, class O>                                                \
  Left<A, Either<K, N, O>, OLD> operator SIGN(const A& a, const Either<K, N, O>&) {         \
    return {a};                                                                             \
  }                                                                                         \
  template <class A, WHAT B, class S>                                                       \
  auto operator SIGN(const Left<A, S, OLD>& left, const B& b)->decltype(OLD{}(left.a, b)) { \
    return S::template apply<OLD>(left.a, b);                                               \
  }
ELROM_INFIX(+, std::plus<>, Number)
ELROM_INFIX(-, std::minus<>, Number)
ELROM_INFIX(*, std::multiplies<>, Number)
ELROM_INFIX(/, std::divides<>, Number)
ELROM_INFIX(<, std::less<>, class)
ELROM_INFIX(<=, std::less_equal<>, class)
ELROM_INFIX(>, std::greater<>, class)
ELROM_INFIX(>=, std::greater_equal<>, class)
ELROM_INFIX(==, std::equal_to<>, class)
ELROM_INFIX(!=, std::not_equal_to<>, class)
#undef ELROM_INFIX

// a += b groups to the right: the switch takes b first.
#define ELROM_ASSIGN(SIGN, OTHER, OLD)                                               \
  template <int K, class N, class O, Number B>                                       \
  Right<B, Either<K, N, O>, OLD> operator SIGN(const Either<K, N, O>&, const B& b) { \
    return {b};                                                                      \
  }                                                                                  \
  template <Number A, class B, int K, class N, class O>                              \
  A& operator SIGN(A& a, const Right<B, Either<K, N, O>, OLD>& right) {              \
    return on(K) ? (a OTHER right.b) : (a SIGN right.b);                             \
  }
ELROM_ASSIGN(+=, -=, std::plus<>)
ELROM_ASSIGN(-=, +=, std::minus<>)
ELROM_ASSIGN(*=, /=, std::multiplies<>)
ELROM_ASSIGN(/=, *=, std::divides<>)
#undef ELROM_ASSIGN

}  // namespace elrom_mutants
