#include "predict_floor.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <functional>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/model/banded_networks.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::benchmark {
namespace {

using Sgemm = void (*)(const char*, const char*, const int*, const int*, const int*, const float*,
                       const float*, const int*, const float*, const int*, const float*, float*, const int*);

double best_seconds(int repeats, const std::function<void()>& work) {
  double best = 1e30;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return best;
}

/// read() of the file from the page cache, shared among the threads.
double read_rate(const std::filesystem::path& path, int n_threads) {
  const auto size = std::filesystem::file_size(path);
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  check(file >= 0, "the bundle can be read");
  constexpr std::size_t block = 1 << 20;
  std::vector<std::vector<char>> buffers(static_cast<std::size_t>(n_threads), std::vector<char>(block));
  const double seconds = best_seconds(9, [&] {
    base::parallel_for((size + block - 1) / block, n_threads, [&](std::size_t i, int worker) {
      check(::pread(file, buffers[static_cast<std::size_t>(worker)].data(), block,
                    static_cast<off_t>(i * block)) > 0,
            "read");
    });
  });
  ::close(file);
  return static_cast<double>(size) / seconds;
}

/// A file of that size written in one go, as plain as can be; with `sync`, waiting until its bytes are on the
/// disk, as elrom-predict leaves its files.
double write_rate(const std::filesystem::path& folder, std::size_t size, bool sync) {
  const std::vector<char> bytes(size, 'x');
  const auto path = folder / "floor.tmp", target = folder / "floor";
  const double seconds = best_seconds(9, [&] {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    check(file >= 0 && ::write(file, bytes.data(), size) == static_cast<ssize_t>(size), "write");
    check(!sync || ::fsync(file) == 0, "sync");
    ::close(file);
    std::filesystem::rename(path, target);
  });
  std::filesystem::remove(target);
  return static_cast<double>(size) / seconds;
}

/// Multiply-adds per second of single-threaded products side by side, at a hidden layer's shape.
double sgemm_rate(int units, int n_planes, int n_threads, bool& blas) {
  ::setenv("OPENBLAS_NUM_THREADS", "1", 1);
  ::setenv("OMP_NUM_THREADS", "1", 1);
  void* library = ::dlopen("libopenblas.so.0", RTLD_NOW | RTLD_LOCAL);
  const auto sgemm = library != nullptr ? reinterpret_cast<Sgemm>(::dlsym(library, "sgemm_")) : nullptr;
  blas = sgemm != nullptr;
  constexpr int calls = 400;
  const double seconds = best_seconds(9, [&] {
    base::parallel_for(static_cast<std::size_t>(n_threads), n_threads, [&](std::size_t, int) {
      MatrixF a = MatrixF::Constant(n_planes, units, 0.5F), b = MatrixF::Constant(units, units, 0.25F),
              c = MatrixF::Zero(n_planes, units);
      const float one = 1, zero = 0;
      for (int i = 0; i < calls; ++i) {
        if (blas) {
          sgemm("N", "N", &units, &n_planes, &units, &one, b.data(), &units, a.data(), &units, &zero,
                c.data(), &units);
        } else {
          c.noalias() = a * b;
        }
      }
      check(c(0, 0) > 0, "a product");
    });
  });
  return static_cast<double>(calls) * n_threads * n_planes * units * units / seconds;
}

struct Work {
  double multiply_adds = 0;
  int units = 128;
};

/// Of networks: every build's layers for all planes, as the bundle combines them. Other kinds of model count
/// as none.
Work work_of(const model::BundleReader& bundle) {
  Work work;
  for (const auto& info : bundle.info().fields) {
    const auto model = bundle.model(info.name);
    const auto* networks = dynamic_cast<const model::BandedNetworks*>(model.get());
    if (networks == nullptr) continue;
    const bool one = networks->parts().combination == model::Combination::best;
    for (const auto& submodel : networks->parts().submodels) {
      const double n_builds = one ? 1 : static_cast<double>(submodel.builds.size());
      const std::size_t n_shared = networks->parts().inputs.size();
      for (const auto& layer : submodel.builds.front().layers()) {
        const bool first = &layer == &submodel.builds.front().layers().front();
        const auto n_out = layer.weights.shape()[0], n_in = layer.weights.shape()[1] - (first ? n_shared : 0);
        work.multiply_adds += n_builds * static_cast<double>(n_out * n_in * bundle.n_planes());
        if (first) work.units = static_cast<int>(n_out);
      }
    }
  }
  return work;
}

}  // namespace

std::string Floor::text() const {
  return fmt::format(
      "floor {:.2f} = read {:.1f} MB at {:.1f} GB/s ({:.2f}) + {:.0f} million multiply-adds at {:.0f}e9/s of "
      "{} ({:.2f}) + "
      "write {:.1f} MB at {:.2f} GB/s{} ({:.2f})",
      total_ms(), bytes_read * 1e-6, read_rate * 1e-9, 1e3 * bytes_read / read_rate, multiply_adds * 1e-6,
      sgemm_rate * 1e-9, blas ? "OpenBLAS" : "Eigen", 1e3 * multiply_adds / sgemm_rate, bytes_written * 1e-6,
      write_rate * 1e-9, synced ? " with fsync" : "", 1e3 * bytes_written / write_rate);
}

nlohmann::json Floor::json() const {
  return {{"bytes_read", bytes_read},
          {"read_rate", read_rate},
          {"bytes_written", bytes_written},
          {"write_rate", write_rate},
          {"synced", synced},
          {"multiply_adds", multiply_adds},
          {"multiply_add_rate", sgemm_rate},
          {"blas", blas}};
}

Floor floor_of(const std::filesystem::path& bundle, const std::filesystem::path& output, int n_threads,
               bool sync) {
  const model::BundleReader reader(bundle);
  Floor floor;
  floor.synced = sync;
  for (const auto& [name, tensor] : reader.file().tensors()) {
    const bool read =
        name.starts_with("fields/") || name.starts_with("guard/") || name.starts_with("mesh/packed/");
    if (read) floor.bytes_read += static_cast<double>(tensor.bytes().size());
  }
  for (const auto& entry : std::filesystem::directory_iterator(output)) {
    if (entry.path().extension() == ".hdf") floor.bytes_written = static_cast<double>(entry.file_size());
  }
  floor.read_rate = read_rate(bundle, n_threads);
  floor.write_rate = write_rate(output, static_cast<std::size_t>(floor.bytes_written), sync);
  const auto work = work_of(reader);
  floor.multiply_adds = work.multiply_adds;
  floor.sgemm_rate = sgemm_rate(work.units, static_cast<int>(reader.n_planes()), n_threads, floor.blas);
  return floor;
}

}  // namespace elrom::benchmark
