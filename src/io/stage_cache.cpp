#include "elrom/io/stage_cache.hpp"

#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"

namespace elrom::io {
namespace {

constexpr std::size_t digest_digits = 20;  // of 64, in the file's name; the file holds all

std::string file_name(const std::string& text) {
  std::string name;
  for (const char c : text)
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' ? c : '_';
  return name;
}

}  // namespace

void StageClock::add(const std::string& stage, double seconds, bool reused) {
  const std::scoped_lock lock(mutex_);
  auto& entry = entries_[stage];
  entry.seconds += seconds;
  ++(reused ? entry.reused : entry.computed);
}

std::map<std::string, StageClock::Entry> StageClock::entries() const {
  const std::scoped_lock lock(mutex_);
  return entries_;
}

StageCache::StageCache(std::filesystem::path folder, Log& log) : folder_(std::move(folder)), log_(log) {
  if (!folder_.empty()) std::filesystem::create_directories(folder_);
}

std::filesystem::path StageCache::path(const std::string& stage, const std::string& name,
                                       const std::string& digest, const std::string& ending) const {
  if (folder_.empty()) return {};
  return folder_ / (stage + "-" + file_name(name) + "-" + digest.substr(0, digest_digits) + ending);
}

bool StageCache::read(const std::filesystem::path& path, const std::string& digest, TensorFile& file) const {
  if (path.empty() || !std::filesystem::exists(path)) return false;
  try {
    file = TensorFile::open(path);
    file.verify_all();
    check_kind(file, kinds::stage);
    if (file.text("stage_digest") == digest) return true;
    log_.warning(path.string() + " belongs to other inputs and is computed again");
  } catch (const Error& error) {
    log_.warning(std::string(error.what()) + "; it is computed again");
  }
  return false;
}

TensorFile StageCache::get(const std::string& stage, const std::string& name, const std::string& digest,
                           const std::function<TensorFile()>& make) const {
  const auto target = path(stage, name, digest, ".elrom");
  const base::Stopwatch watch;
  TensorFile file;
  if (read(target, digest, file)) {
    clock_.add(stage, watch.seconds(), true);
    return file;
  }
  file = make();
  if (!target.empty()) {
    write_kind(file, kinds::stage);
    file.set_text("stage", stage);
    file.set_text("name", name);
    file.set_text("stage_digest", digest);
    file.write(target);
    file = TensorFile::open(target);  // mapped: what a study keeps does not stay in memory
  }
  clock_.add(stage, watch.seconds(), false);
  return file;
}

}  // namespace elrom::io
