#include "sha256_lanes.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#if defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>
#endif

#include "elrom/base/error.hpp"

namespace elrom::base {

#if defined(__x86_64__)
namespace {

constexpr std::size_t block_bytes = 64;

// FIPS 180-4, 4.2.2: the first 32 bits of the fractional parts of the cube roots of the first 64 primes.
alignas(16) constexpr std::uint32_t round_constants[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};
constexpr Sha256Words start{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                            0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};

/// A text on its way through a lane: its whole blocks where they lie, then one or two of padding.
struct Text {
  const std::byte* next = nullptr;
  std::size_t blocks = 0;  // left at `next`
  Sha256Words state = start;
  std::array<std::byte, 2 * block_bytes> tail{};
  std::size_t tail_blocks = 0;  // 0: begun
  std::size_t place = 0;        // among the texts asked for

  Text() = default;
  Text(std::span<const std::byte> bytes, std::size_t place_)
      : next(bytes.data()), blocks(bytes.size() / block_bytes), place(place_) {
    const std::size_t rest = bytes.size() % block_bytes;
    if (rest > 0) std::memcpy(tail.data(), bytes.data() + blocks * block_bytes, rest);
    tail[rest] = std::byte{0x80};
    tail_blocks = rest + 9 <= block_bytes ? 1 : 2;
    const std::uint64_t bits = 8 * static_cast<std::uint64_t>(bytes.size());
    for (std::size_t i = 0; i < 8; ++i)
      tail[tail_blocks * block_bytes - 1 - i] = static_cast<std::byte>(bits >> (8 * i));
  }
  /// Goes on to the padding where the body has ended. @return false when that has ended too
  bool more() {
    if (blocks > 0) return true;
    if (tail_blocks == 0) return false;
    next = tail.data();
    blocks = std::exchange(tail_blocks, 0);
    return true;
  }
};

/// The next n_blocks of every text, in step. The instructions keep the state as (a, b, e, f) and (c, d, g,
/// h), do two rounds at a time, and make four words of the message schedule from the sixteen before.
template <std::size_t n_lanes>
__attribute__((target("sha,sse4.1,ssse3"))) void compress(std::array<Text*, n_lanes> texts,
                                                          std::size_t n_blocks) {
  const __m128i big_endian = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  __m128i abef[n_lanes], cdgh[n_lanes];
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    const auto* state = reinterpret_cast<const __m128i*>(texts[lane]->state.data());
    const __m128i dcba = _mm_loadu_si128(state), hgfe = _mm_loadu_si128(state + 1);
    const __m128i cdab = _mm_shuffle_epi32(dcba, 0xb1), efgh = _mm_shuffle_epi32(hgfe, 0x1b);
    abef[lane] = _mm_alignr_epi8(cdab, efgh, 8);
    cdgh[lane] = _mm_blend_epi16(efgh, cdab, 0xf0);
  }
  for (std::size_t block = 0; block < n_blocks; ++block) {
    __m128i words[n_lanes][4], abef_before[n_lanes], cdgh_before[n_lanes];
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      abef_before[lane] = abef[lane];
      cdgh_before[lane] = cdgh[lane];
    }
#pragma GCC unroll 16
    for (int i = 0; i < 16; ++i) {
      const __m128i constants = _mm_load_si128(reinterpret_cast<const __m128i*>(round_constants) + i);
#pragma GCC unroll 2
      for (std::size_t lane = 0; lane < n_lanes; ++lane) {
        auto& w = words[lane];
        if (i < 4) {
          const auto* from = reinterpret_cast<const __m128i*>(texts[lane]->next + block * block_bytes) + i;
          w[i] = _mm_shuffle_epi8(_mm_loadu_si128(from), big_endian);
        } else {
          const __m128i minus_7 = _mm_alignr_epi8(w[(i + 3) % 4], w[(i + 2) % 4], 4);
          w[i % 4] = _mm_sha256msg2_epu32(
              _mm_add_epi32(_mm_sha256msg1_epu32(w[i % 4], w[(i + 1) % 4]), minus_7), w[(i + 3) % 4]);
        }
        const __m128i sum = _mm_add_epi32(w[i % 4], constants);
        cdgh[lane] = _mm_sha256rnds2_epu32(cdgh[lane], abef[lane], sum);
        abef[lane] = _mm_sha256rnds2_epu32(abef[lane], cdgh[lane], _mm_shuffle_epi32(sum, 0x0e));
      }
    }
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      abef[lane] = _mm_add_epi32(abef[lane], abef_before[lane]);
      cdgh[lane] = _mm_add_epi32(cdgh[lane], cdgh_before[lane]);
    }
  }
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    const __m128i feba = _mm_shuffle_epi32(abef[lane], 0x1b), dchg = _mm_shuffle_epi32(cdgh[lane], 0xb1);
    auto* state = reinterpret_cast<__m128i*>(texts[lane]->state.data());
    _mm_storeu_si128(state, _mm_blend_epi16(feba, dchg, 0xf0));
    _mm_storeu_si128(state + 1, _mm_alignr_epi8(dchg, feba, 8));
    texts[lane]->next += n_blocks * block_bytes;
    texts[lane]->blocks -= n_blocks;
  }
}

}  // namespace

bool has_sha_instructions() {
  static const bool has = [] {
    unsigned a = 0, b = 0, c = 0, d = 0;
    const bool sha = __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 && (b & (1U << 29)) != 0;
    const bool sse41 = __get_cpuid(1, &a, &b, &c, &d) != 0 && (c & (1U << 19)) != 0;
    return sha && sse41;
  }();
  return has;
}

std::vector<Sha256Words> sha256_in_lanes(std::span<const std::span<const std::byte>> texts) {
  std::vector<Sha256Words> digests(texts.size());
  // Longest first: the two lanes then end at nearly the same time.
  std::vector<std::size_t> order(texts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t i) { return texts[i].size(); });
  std::size_t n_begun = 0;
  const auto begin = [&](Text& text) {
    if (n_begun == order.size()) return false;
    const auto place = order[n_begun++];
    text = Text(texts[place], place);
    return true;
  };
  // Brings a lane to its next block. @return false when there is none for it
  const auto goes_on = [&](Text& text) {
    while (!text.more()) {
      digests[text.place] = text.state;
      if (!begin(text)) return false;
    }
    return true;
  };
  Text first, second;
  if (!begin(first)) return digests;
  bool first_works = true, second_works = begin(second);
  while (first_works || second_works) {
    if (first_works) first_works = goes_on(first);
    if (second_works) second_works = goes_on(second);
    if (first_works && second_works)
      compress<2>({&first, &second}, std::min(first.blocks, second.blocks));
    else if (first_works)
      compress<1>({&first}, first.blocks);
    else if (second_works)
      compress<1>({&second}, second.blocks);
  }
  return digests;
}

#else

bool has_sha_instructions() { return false; }
std::vector<Sha256Words> sha256_in_lanes(std::span<const std::span<const std::byte>>) {
  check(false, "sha256_in_lanes: no such instructions here");
  return {};
}

#endif

}  // namespace elrom::base
