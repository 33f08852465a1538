#pragma once
// A prediction's .hdf file on its way: all of it but the values
// is written first, and each field when it is ready.

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "elrom/base/atomic_file.hpp"
#include "elrom/model/prediction_file.hpp"

namespace elrom::fields {

/// Thread rule: begin() in one thread, offer_field() meanwhile in any, finish() after all of them.
class HdfFile {
 public:
  struct Begun {
    std::unique_ptr<base::AtomicFile> file;
    model::PredictionWriter writer;
  };
  /// @param library guards the HDF5 library
  HdfFile(std::mutex& library, std::function<Begun()> make) : library_(library), make_(std::move(make)) {}
  ~HdfFile() {  // what an exception leaves open is closed by the library too
    const std::scoped_lock lock(library_);
    begun_.reset();
  }
  HdfFile(const HdfFile&) = delete;
  HdfFile& operator=(const HdfFile&) = delete;

  void begin() {
    const std::scoped_lock lock(library_);
    begun_.emplace(make_());
    is_begun_ = true;
  }
  /// Writes a field if the file has been begun; finish() writes it otherwise.
  void offer_field(const model::Prediction& prediction, std::size_t i) {
    if (!is_begun_) return;
    const std::scoped_lock lock(library_);
    begun_->writer.write_field(prediction, i);
    begun_->file->begin_sync();
  }
  void finish(const model::Prediction& prediction) {
    if (!is_begun_) begin();
    {
      const std::scoped_lock lock(library_);
      begun_->writer.finish(prediction);
    }
    begun_->file->commit();
  }

 private:
  std::mutex& library_;
  std::function<Begun()> make_;
  std::optional<Begun> begun_;
  std::atomic<bool> is_begun_{false};
};

}  // namespace elrom::fields
