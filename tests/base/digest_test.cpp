#include "elrom/base/digest.hpp"

#include <gtest/gtest.h>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/random.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::base {
namespace {

std::string of(std::string_view text) { return sha256(std::as_bytes(std::span(text))); }

// Oracles: the examples of FIPS 180-4 (NIST's published vectors).
TEST(Sha256, MatchesThePublishedVectors) {
  EXPECT_EQ(of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

// Oracle: the digests one by one, which OpenSSL computes.
TEST(Sha256, OfEachIsThatOfEveryTextByItself) {
  Random random(Seed(4));
  std::vector<std::vector<std::byte>> texts;
  for (std::size_t size = 0; size < 200; ++size) texts.emplace_back(size);  // every way to pad
  for (const std::size_t size : {4096, 64 * 1000, 12345, 64 * 999 + 55, 64 * 7 + 56})
    texts.emplace_back(size);
  for (auto& text : texts)
    for (auto& byte : text) byte = static_cast<std::byte>(random());
  for (int round = 0; round < 5; ++round) {
    random.shuffle(texts);
    for (const std::size_t n :
         {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{3}, texts.size()}) {
      const std::vector<std::span<const std::byte>> some(texts.begin(),
                                                         texts.begin() + static_cast<std::ptrdiff_t>(n));
      const auto digests = sha256_of_each(some);
      ASSERT_EQ(digests.size(), n);
      for (std::size_t i = 0; i < n; ++i)
        EXPECT_EQ(digests[i], sha256(texts[i])) << texts[i].size() << " bytes";
    }
  }
}

TEST(Sha256, OfEachStartsAndEndsAnywhere) {
  // Every text ends where its memory does: a sanitizer sees a byte read too many.
  Random random(Seed(5));
  for (std::size_t skipped = 0; skipped < 16; ++skipped) {
    std::vector<std::byte> one(64 * 3 + skipped), other(64 * 40 + skipped);
    for (auto* text : {&one, &other})
      for (auto& byte : *text) byte = static_cast<std::byte>(random());
    const std::span<const std::byte> a = std::span(one).subspan(skipped),
                                     b = std::span(other).subspan(skipped);
    const std::span<const std::byte> both[] = {a, b};
    EXPECT_EQ(sha256_of_each(both), (std::vector{sha256(a), sha256(b)})) << skipped << " bytes in";
  }
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const test::TemporaryFolder folder;
  for (const std::size_t size : {0UL, 1UL, 1UL << 20, (1UL << 20) + 7}) {
    const std::string text(size, 'x');
    write_text(folder / "file", text);
    EXPECT_EQ(sha256_file(folder / "file"), of(text)) << size;
  }
}

TEST(Sha256, TextsAreDelimited) {
  EXPECT_NE(Sha256().add("ab").add("c").hex(), Sha256().add("a").add("bc").hex());
}

}  // namespace
}  // namespace elrom::base
