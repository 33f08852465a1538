#include "elrom/base/digest.hpp"

#include <gtest/gtest.h>

namespace elrom::base {
namespace {

std::string of(std::string_view text) { return sha256(std::as_bytes(std::span(text))); }

// Oracles: the examples of FIPS 180-4 (NIST's published vectors).
TEST(Sha256, MatchesThePublishedVectors) {
  EXPECT_EQ(of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, TextsAreDelimited) {
  EXPECT_NE(Sha256().add("ab").add("c").hex(), Sha256().add("a").add("bc").hex());
}

}  // namespace
}  // namespace elrom::base
