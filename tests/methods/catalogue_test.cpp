#include "elrom/methods/catalogue.hpp"

#include <gmock/gmock.h>

#include <set>

#include "elrom/methods/peers.hpp"

namespace elrom::methods {
namespace {

TEST(Catalogue, EveryMethodIsFoundByItsNameAndHasAPlaceOfItsOwn) {
  std::set<int> places;
  for (const auto& info : catalogue()) {
    EXPECT_EQ(find_method(info.name), &info);
    EXPECT_TRUE(places.insert(info.place).second) << info.name;
  }
  EXPECT_EQ(find_method("auto"), nullptr) << "a choice among methods, and none itself";
}

TEST(Catalogue, EveryPeerOfItCanBeMade) {
  for (const auto& name : closed_form_peers()) EXPECT_EQ(make_peer(name)->name(), name);
  EXPECT_EQ(peer_names().size(), 6U);
}

}  // namespace
}  // namespace elrom::methods
