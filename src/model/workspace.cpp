#include <algorithm>
#include <new>

#include "elrom/model/field_model.hpp"

namespace elrom::model {
namespace {

constexpr std::size_t cache_line = 64;
constexpr std::size_t floats_a_line = cache_line / sizeof(float);
constexpr std::size_t smallest_block = 1 << 16;  // floats: one plane of layers without a second block

float* allocate(std::size_t n) {
  return static_cast<float*>(::operator new[](n * sizeof(float), std::align_val_t{cache_line}));
}
void release(float* data) { ::operator delete[](data, std::align_val_t{cache_line}); }

}  // namespace

std::span<float> Workspace::floats(std::size_t n) {
  const std::size_t needed = (n + floats_a_line - 1) / floats_a_line * floats_a_line;
  // Blocks are never moved, so spans handed out before stay valid when a bigger one has to be added.
  while (block_ < blocks_.size() && blocks_[block_].size - used_ < needed) {
    ++block_;
    used_ = 0;
  }
  if (block_ == blocks_.size()) {
    const std::size_t size =
        std::max({needed, smallest_block, blocks_.empty() ? 0 : 2 * blocks_.back().size});
    blocks_.push_back({{allocate(size), release}, size});
  }
  float* data = blocks_[block_].data.get() + used_;
  used_ += needed;
  return {data, n};
}

}  // namespace elrom::model
