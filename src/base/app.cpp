#include "elrom/base/app.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>
#include <thread>

#include "elrom/base/error.hpp"

namespace elrom::base {
namespace {

int report(std::string_view program, std::string_view message, ExitStatus status) {
  fmt::print(stderr, "{}: error: {}\n", program, message);
  return static_cast<int>(status);
}

// Set by a signal, read by another thread.
std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not wait");

extern "C" void on_interrupt(int signal) {
  if (interrupted.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

int run_app(std::string_view program, const std::function<int()>& body) noexcept {
  try {
    return body();
  } catch (const Error& error) {
    return report(program, error.what(), error.status());
  } catch (const std::bad_alloc&) {
    return report(program, "out of memory; ask for fewer fields, cases or builds at a time",
                  ExitStatus::internal);
  } catch (const std::filesystem::filesystem_error& error) {
    return report(program, error.path1().string() + ": " + error.code().message(), ExitStatus::internal);
  } catch (const std::system_error& error) {
    const bool exhausted = error.code() == std::errc::resource_unavailable_try_again;
    return report(program, std::string(error.what()) + (exhausted ? "; no more threads or memory" : ""),
                  ExitStatus::internal);
  } catch (const std::exception& error) {
    return report(program, error.what(), ExitStatus::internal);
  } catch (...) {
    return report(program, "unknown failure", ExitStatus::internal);
  }
}

void keep_freed_memory() noexcept {
#ifdef __GLIBC__
  constexpr int more_than_a_matrix = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, more_than_a_matrix);
  mallopt(M_TRIM_THRESHOLD, more_than_a_matrix);
#endif
}

std::stop_token interrupt_token() {
  // A signal handler may not request a stop (it takes locks), so a small watcher thread does.
  static std::stop_source source;
  static std::jthread watcher = [] {
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    return std::jthread([](const std::stop_token& end) {
      while (!end.stop_requested()) {
        if (interrupted) {
          source.request_stop();
          return;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    });
  }();
  return source.get_token();
}

}  // namespace elrom::base
