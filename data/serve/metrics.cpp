#include "metrics.hpp"

#include <fmt/format.h>

#include "elrom/base/text.hpp"

namespace elrom::serve {

void Metrics::count(const std::string& route, int status, double seconds, std::size_t bytes) {
  const std::scoped_lock lock(mutex_);
  ++requests_[{route, status}];
  auto& times = times_[route];
  for (std::size_t i = 0; i < edges_s.size(); ++i)
    if (seconds <= edges_s[i]) ++times.up_to[i];
  ++times.n;
  times.seconds += seconds;
  bytes_ += static_cast<double>(bytes);
}

std::string Metrics::text(const std::map<std::string, double>& gauges) const {
  const std::scoped_lock lock(mutex_);
  std::string text = "# TYPE elrom_requests_total counter\n";
  for (const auto& [key, n] : requests_)
    text += fmt::format("elrom_requests_total{{route=\"{}\",status=\"{}\"}} {}\n", key.first, key.second, n);
  text += "# TYPE elrom_request_seconds histogram\n";
  for (const auto& [route, times] : times_) {
    for (std::size_t i = 0; i < edges_s.size(); ++i)
      text += fmt::format("elrom_request_seconds_bucket{{route=\"{}\",le=\"{}\"}} {}\n", route,
                          base::number(edges_s[i]), times.up_to[i]);
    text += fmt::format(
        "elrom_request_seconds_bucket{{route=\"{0}\",le=\"+Inf\"}} {1}\n"
        "elrom_request_seconds_count{{route=\"{0}\"}} {1}\nelrom_request_seconds_sum{{route=\"{0}\"}} {2}\n",
        route, times.n, base::number(times.seconds));
  }
  text += fmt::format("# TYPE elrom_answer_bytes_total counter\nelrom_answer_bytes_total {}\n",
                      base::number(bytes_));
  for (const auto& [name, value] : gauges)
    text += fmt::format("# TYPE elrom_{0} gauge\nelrom_{0} {1}\n", name, base::number(value));
  return text;
}

}  // namespace elrom::serve
