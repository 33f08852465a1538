#include "elrom/io/tensor_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "mapped_file.hpp"
#include "tensor_header.hpp"

static_assert(std::endian::native == std::endian::little, "tensor files are little-endian");

namespace elrom::io {
namespace {

constexpr std::size_t length_bytes = 8;

[[noreturn]] void refuse(const std::string& where, std::string what, std::string found,
                         std::string expected) {
  throw InputError({.what = std::move(what),
                    .where = where,
                    .found = std::move(found),
                    .expected = std::move(expected),
                    .advice = "the file is damaged; copy or write it again"});
}

std::string_view header_text(std::span<const std::byte> bytes, const std::string& where) {
  std::uint64_t length = 0;
  if (bytes.size() < length_bytes)
    refuse(where, "file cut short", std::to_string(bytes.size()) + " bytes", "a header");
  std::memcpy(&length, bytes.data(), length_bytes);
  if (length > largest_header || length > bytes.size() - length_bytes) {
    refuse(where, "no tensor file, or cut short", "a header of " + std::to_string(length) + " bytes",
           "at most " + std::to_string(std::min<std::uint64_t>(largest_header, bytes.size() - length_bytes)));
  }
  return {reinterpret_cast<const char*>(bytes.data()) + length_bytes, static_cast<std::size_t>(length)};
}

/// Biggest power of two up to 64 that divides a tensor's size. Tensors are laid out by falling alignment, so
/// that each begins at a multiple of its own without any padding, which the layout forbids.
std::size_t alignment_of(const Tensor& tensor) {
  std::size_t alignment = 64;
  while (tensor.bytes().size() % alignment != 0) alignment /= 2;
  return alignment;
}

std::vector<const std::pair<const std::string, Tensor>*> layout_order(
    const std::map<std::string, Tensor>& tensors) {
  std::vector<const std::pair<const std::string, Tensor>*> order;
  for (const auto& item : tensors) order.push_back(&item);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
    return alignment_of(a->second) > alignment_of(b->second);
  });
  return order;
}

std::string digest_key(std::string_view name) {
  return std::string(digest_prefix) + "tensor/" + std::string(name);
}

void write_bytes(std::ofstream& stream, std::span<const std::byte> bytes) {
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

TensorFile TensorFile::open(const std::filesystem::path& path, Verify verify) {
  const auto mapping = MappedFile::open(path);
  const auto bytes = mapping->bytes();
  TensorFile file;
  file.verify_ = verify;
  file.where_ = path.string();
  const auto json = header_text(bytes, file.where_);
  const auto* data = bytes.data() + length_bytes + json.size();
  auto header = parse_header(json, bytes.size() - length_bytes - json.size(), file.where_);

  file.digest_ = header_digest(json);
  const auto stored = header.metadata.find(std::string(header_digest_key));
  if (stored == header.metadata.end() || stored->second != file.digest_) {
    refuse(file.where_, "header does not match its SHA-256", file.digest_,
           stored == header.metadata.end() ? "a digest under sha256:header" : stored->second);
  }
  for (auto& [name, entry] : header.tensors) {
    const auto digest = header.metadata.find(digest_key(name));
    if (digest == header.metadata.end())
      refuse(file.where_ + ":" + name, "tensor without a digest", "none", "a SHA-256");
    const auto* begin = data + entry.begin;
    if (reinterpret_cast<std::uintptr_t>(begin) % size_of(entry.type) != 0) {
      refuse(file.where_ + ":" + name, "misaligned tensor", "offset " + std::to_string(entry.begin),
             "a multiple of " + std::to_string(size_of(entry.type)));
    }
    file.digests_.emplace(name, std::move(digest->second));
    file.tensors_.emplace(name, Tensor(entry.type, std::move(entry.shape), mapping, begin));
  }
  for (auto& [key, text] : header.metadata) {
    if (!key.starts_with(digest_prefix)) file.texts_.emplace(key, std::move(text));
  }
  return file;
}

const Tensor& TensorFile::tensor(std::string_view name) const {
  const Tensor& found = find(name);
  if (verify_ == Verify::on_use) compare(std::array{std::string(name)}, std::span(&found, 1));
  return found;
}

std::vector<Tensor> TensorFile::tensors(std::span<const std::string> names) const {
  std::vector<Tensor> found;
  found.reserve(names.size());
  for (const auto& name : names) found.push_back(find(name));
  if (verify_ == Verify::on_use) compare(names, found);
  return found;
}

const Tensor& TensorFile::find(std::string_view name) const {
  const auto found = tensors_.find(std::string(name));
  if (found != tensors_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& item : tensors_) names.push_back(item.first);
  throw InputError({.what = "no tensor '" + std::string(name) + "'",
                    .where = where_,
                    .advice = base::name_advice(name, names)});
}

const Tensor& TensorFile::tensor(std::string_view name, std::span<const std::size_t> shape) const {
  const Tensor& found = tensor(name);
  const auto fits = [](std::size_t have, std::size_t want) { return want == any_size || have == want; };
  if (std::equal(found.shape().begin(), found.shape().end(), shape.begin(), shape.end(), fits)) return found;
  const auto text = [](std::span<const std::size_t> sizes) {
    std::vector<std::string> parts;
    for (const auto n : sizes) parts.push_back(n == any_size ? "any" : std::to_string(n));
    return "(" + base::join(parts, ", ") + ")";
  };
  throw InputError({.what = "tensor of another shape",
                    .where = where_ + ":" + std::string(name),
                    .found = text(found.shape()),
                    .expected = text(shape)});
}

const std::string& TensorFile::text(std::string_view key) const {
  const auto found = texts_.find(std::string(key));
  if (found != texts_.end()) return found->second;
  std::vector<std::string> keys;
  for (const auto& item : texts_) keys.push_back(item.first);
  throw InputError({.what = "no text '" + std::string(key) + "'",
                    .where = where_,
                    .advice = base::name_advice(key, keys)});
}

void TensorFile::set(std::string name, Tensor tensor) {
  check(!name.empty() && name != metadata_key, "a tensor needs a name of its own");
  digests_.erase(name);
  tensors_.insert_or_assign(std::move(name), std::move(tensor));
}

void TensorFile::set_text(std::string key, std::string text) {
  check(!key.starts_with(digest_prefix), "texts may not look like digests");
  texts_.insert_or_assign(std::move(key), std::move(text));
}

void TensorFile::verify(std::string_view name) const {
  const Tensor& found = find(name);
  compare(std::array{std::string(name)}, std::span(&found, 1));
}

void TensorFile::compare(std::span<const std::string> names, std::span<const Tensor> tensors) const {
  std::vector<const std::string*> stored, name_of;
  std::vector<std::span<const std::byte>> bytes;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto digest = digests_.find(names[i]);
    if (digest == digests_.end()) continue;  // made in memory: nothing to compare with
    stored.push_back(&digest->second);
    name_of.push_back(&names[i]);
    bytes.push_back(tensors[i].bytes());
  }
  const auto found = base::sha256_of_each(bytes);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] != *stored[i])
      refuse(where_ + ":" + *name_of[i], "tensor does not match its SHA-256", found[i], *stored[i]);
  }
}

void TensorFile::verify_all(int n_threads) const {
  std::vector<const std::string*> names;
  for (const auto& item : tensors_) names.push_back(&item.first);
  base::parallel_for(names.size(), n_threads, [&](std::size_t i, int) { verify(*names[i]); });
}

void TensorFile::write(const std::filesystem::path& path) const {
  TensorHeader header;
  header.metadata = texts_;
  header.metadata[std::string(header_digest_key)] = std::string(digest_length, '0');
  const auto order = layout_order(tensors_);
  std::uint64_t reached = 0;
  for (const auto* item : order) {
    const auto bytes = item->second.bytes();
    header.tensors[item->first] = {item->second.type(), item->second.shape(), reached,
                                   reached + bytes.size()};
    header.metadata[digest_key(item->first)] = base::sha256(bytes);
    reached += bytes.size();
  }
  auto digest = header_digest(format_header(header));
  header.metadata[std::string(header_digest_key)] = digest;
  const std::string json = format_header(header);
  if (order.size() > most_tensors || json.size() > largest_header) {
    throw UsageError({.what = "too many networks for one file",
                      .where = path.string(),
                      .found = std::to_string(order.size()) + " tensors in a header of " +
                               std::to_string(json.size()) + " bytes",
                      .expected = "at most " + std::to_string(most_tensors) + " tensors and " +
                                  std::to_string(largest_header) + " bytes",
                      .advice = "fewer builds, bands or blocks of columns"});
  }
  base::AtomicFile target(path);
  std::ofstream stream(target.temporary(), std::ios::binary);
  const std::uint64_t length = json.size();
  write_bytes(stream, std::as_bytes(std::span(&length, 1)));
  write_bytes(stream, std::as_bytes(std::span(json)));
  for (const auto* item : order) write_bytes(stream, item->second.bytes());
  stream.close();
  if (!stream)
    throw SystemError({.what = "cannot write", .where = path.string(), .advice = "is the disk full?"});
  target.commit();
  digest_ = std::move(digest);
}

void write_kind(TensorFile& file, const FileKind& kind) {
  file.set_text("kind", std::string(kind.name));
  file.set_text("format", kind.version.text());
  file.set_text("program", program_version());
}

FormatVersion check_kind(const TensorFile& file, const FileKind& expected) {
  const auto text = [&](const char* key) {
    return file.has_text(key) ? std::optional(file.text(key)) : std::nullopt;
  };
  return check_kind({text("kind"), text("format"), text("program")}, expected, file.where());
}

}  // namespace elrom::io
