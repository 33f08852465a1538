// What a row of the table of routes promises, by what it asks for.
#include "route.hpp"

#include <gmock/gmock.h>

namespace elrom::serve {
namespace {

using ::testing::ElementsAre;

std::vector<int> statuses(const Route& route) {
  std::vector<int> all;
  for (const auto& one : all_answers(route)) all.push_back(one.status);
  return all;
}

TEST(Route, PromisesNothingThatItDoesNotAskFor) {
  EXPECT_THAT(statuses({.method = "GET", .path = "/about", .answers = {{200, "yes"}}}), ElementsAre(200));
}

TEST(Route, ReadersAreNeverRefusedForTheirRole) {
  EXPECT_THAT(statuses({.method = "GET",
                        .path = "/models/{id}",
                        .role = repository::Role::reader,
                        .answers = {{200, "it"}},
                        .tagged = true}),
              ElementsAre(200, 304, 401, 404));
  EXPECT_THAT(statuses({.method = "GET", .path = "/files/{digest}", .role = repository::Role::reader}),
              ElementsAre(401, 404));
}

TEST(Route, RefusesBodiesKeysAndConditions) {
  EXPECT_THAT(statuses({.method = "POST",
                        .path = "/scenarios",
                        .role = repository::Role::model,
                        .answers = {{201, "made"}},
                        .body = BodyKind::json,
                        .keyed = true}),
              ElementsAre(201, 400, 401, 403, 409, 413, 415, 422, 428));
  EXPECT_THAT(statuses({.method = "PUT",
                        .path = "/scenarios/{id}",
                        .role = repository::Role::model,
                        .body = BodyKind::hdf,
                        .locked = true}),
              ElementsAre(401, 403, 404, 412, 413, 415, 428));
}

TEST(Route, SaysItsOwnMeaningOfAStatus) {
  const Route route{.method = "GET",
                    .path = "/models/{id}",
                    .role = repository::Role::reader,
                    .answers = {{404, "no model of that name"}}};

  const auto answers = all_answers(route);

  EXPECT_THAT(statuses(route), ElementsAre(401, 404));
  EXPECT_EQ(answers.back().meaning, "no model of that name");
}

}  // namespace
}  // namespace elrom::serve
