#pragma once
// Counts and times of requests, as Prometheus reads them (text format 0.0.4).
//
// Thread rule: any thread.

#include <array>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace elrom::serve {

class Metrics {
 public:
  /// @param route as in the table: few different ones
  void count(const std::string& route, int status, double seconds, std::size_t bytes);
  /// @param gauges name and value of what is there now
  [[nodiscard]] std::string text(const std::map<std::string, double>& gauges) const;

 private:
  static constexpr std::array<double, 10> edges_s{0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 1, 10};
  struct Times {
    std::array<std::size_t, edges_s.size()> up_to{};  //!< requests that took at most so long
    std::size_t n = 0;
    double seconds = 0;
  };
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, int>, std::size_t> requests_;
  std::map<std::string, Times> times_;
  double bytes_ = 0;
};

}  // namespace elrom::serve
