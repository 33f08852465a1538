#include "transact.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include "elrom/base/error.hpp"

namespace elrom::repository {
namespace {

constexpr int most_tries = 100;

/// Longer from time to time, and never in step with those that one lost against.
void pause(int n_lost) {
  constexpr int longest_us = 20000;
  thread_local std::minstd_rand random(std::random_device{}());
  const int most = std::min(longest_us, 100 << std::min(n_lost, 8));
  std::this_thread::sleep_for(std::chrono::microseconds(std::uniform_int_distribution(0, most)(random)));
}

}  // namespace

void transact(Connection& connection, bool writes, const std::function<void()>& work) {
  for (int n_lost = 0; n_lost < most_tries; ++n_lost) {
    try {
      connection.begin(writes);
      work();
      return connection.commit();
    } catch (const LostRace&) {
      connection.rollback();
    } catch (...) {
      connection.rollback();
      throw;
    }
    pause(n_lost);
  }
  throw SystemError(Problem{.what = "too many writers at once", .advice = "try again later"});
}

}  // namespace elrom::repository
