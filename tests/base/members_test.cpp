#include "elrom/base/members.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "support/changed_members.hpp"

namespace elrom::base {
namespace {

enum class Paint { red, green };
struct Inner {
  int x = 0;
  std::vector<double> list;
};
struct WithKey {
  explicit WithKey(std::string text) : text_(std::move(text)) {}
  [[nodiscard]] const std::string& key() const { return text_; }

 private:
  std::string text_;
};
struct Everything {
  bool flag = false;
  Paint colour = Paint::red;
  double number = 0;
  std::uint64_t whole = 0;
  std::string text;
  std::vector<std::string> texts;
  std::vector<bool> bits;
  Inner inner;
  static constexpr int not_a_member = 7;
};
struct Rest {
  std::optional<double> maybe;
  std::map<std::string, int> table;
  std::pair<int, std::string> pair;
  Eigen::MatrixXf matrix;
  const WithKey* key;
  Seed seed;  // has no default
};

static_assert(n_members<Inner>() == 2);
static_assert(n_members<Everything>() == 8);
static_assert(n_members<Rest>() == 6);

TEST(Members, AreVisitedInTheOrderOfDeclaration) {
  std::string visited;
  for_each_member(std::as_const(*std::make_unique<Inner>()), [&](const auto& member) {
    visited += std::is_same_v<std::decay_t<decltype(member)>, int> ? "x" : "list";
  });

  EXPECT_EQ(visited, "xlist");
}

TEST(Members, TheDigestKnowsEachOfThem) {
  std::set<std::string> digests{digest_of_members(Everything{})};
  for (const auto& changed : test::each_member_changed(Everything{}))
    digests.insert(digest_of_members(changed));

  EXPECT_EQ(digests.size(), 1 + n_members<Everything>());
  EXPECT_EQ(digest_of_members(Everything{}), digest_of_members(Everything{}));
}

TEST(Members, OptionalsTablesPairsMatricesSeedsAndKeysCount) {
  const WithKey one("one"), other("other"), also_one("one");
  const Rest rest{std::nullopt, {}, {1, "a"}, Eigen::MatrixXf::Zero(2, 3), &one, Seed(1)};
  std::vector<Rest> all(8, rest);
  all[1].maybe = 0;
  all[2].table["a"] = 1;
  all[3].pair.second = "b";
  all[4].matrix = Eigen::MatrixXf::Zero(3, 2);
  all[5].matrix(1, 2) = 1;
  all[6].key = &other;
  all[7].seed = Seed(2);
  std::set<std::string> digests;
  for (const auto& each : all) digests.insert(digest_of_members(each));
  auto equal = rest;
  equal.key = &also_one;

  EXPECT_EQ(digests.size(), all.size());
  EXPECT_EQ(digest_of_members(equal), digest_of_members(rest)) << "by key, not by address";
}

TEST(Members, ListsAreDelimited) {
  using Texts = std::vector<std::string>;
  EXPECT_NE(digest_of_members(Texts{"a"}, Texts{"b", "c"}), digest_of_members(Texts{"a", "b"}, Texts{"c"}));
}

}  // namespace
}  // namespace elrom::base
