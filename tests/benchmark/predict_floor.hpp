#pragma once
// The least time that a prediction could take here: bytes in,
// multiply-adds, bytes out, each at its measured rate.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace elrom::benchmark {

struct Floor {
  double bytes_read = 0, read_rate = 0;  ///< bytes, bytes/s
  double bytes_written = 0, write_rate = 0;
  double multiply_adds = 0, sgemm_rate = 0;  ///< 1/s
  bool synced = false;                       ///< the writing includes waiting for the disk
  bool blas = false;                         ///< OpenBLAS' sgemm; else Eigen's

  [[nodiscard]] double total_ms() const {
    return 1e3 * (bytes_read / read_rate + bytes_written / write_rate + multiply_adds / sgemm_rate);
  }
  [[nodiscard]] std::string text() const;
  [[nodiscard]] nlohmann::json json() const;
};

/// @param sync counts waiting until the file is on the disk, as elrom-predict does without --no-sync
/// @param output folder with a prediction file of that bundle: its size is what is written
[[nodiscard]] Floor floor_of(const std::filesystem::path& bundle, const std::filesystem::path& output,
                             int n_threads, bool sync);

}  // namespace elrom::benchmark
