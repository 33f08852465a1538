#include "problem.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/repository/transaction.hpp"

namespace elrom::serve {
namespace {

using Json = nlohmann::json;

TEST(Problem, KeepsTheErrorsPartsApart) {
  const auto response = problem_response(InputError({.what = "impossible primary_air",
                                                     .where = "case a",
                                                     .found = "-3 kg/s",
                                                     .expected = "0 to 1e6 kg/s",
                                                     .advice = "look at the sensor"}));

  EXPECT_EQ(response.status, 422);
  EXPECT_EQ(*response.header("Content-Type"), "application/problem+json");
  EXPECT_EQ(
      Json::parse(response.body),
      (Json{{"type", "about:blank"},
            {"title", "Unprocessable Content"},
            {"status", 422},
            {"detail",
             "impossible primary_air in case a: found -3 kg/s, expected 0 to 1e6 kg/s; look at the sensor"},
            {"what", "impossible primary_air"},
            {"where", "case a"},
            {"found", "-3 kg/s"},
            {"expected", "0 to 1e6 kg/s"},
            {"advice", "look at the sensor"}}));
}

TEST(Problem, TheStatusIsThatOfTheKind) {
  EXPECT_EQ(problem_response(UsageError("x")).status, 400);
  EXPECT_EQ(problem_response(repository::NotFoundError("x")).status, 404);
  EXPECT_EQ(problem_response(repository::ConflictError("x")).status, 409);
  EXPECT_EQ(problem_response(repository::StaleError("x")).status, 412);
  EXPECT_EQ(problem_response(NotBuiltError("x")).status, 501);
  EXPECT_EQ(problem_response(SystemError("x")).status, 503);
  EXPECT_EQ(problem_response(std::bad_alloc()).status, 503);
}

TEST(Problem, OurOwnMistakesAreNotExplainedToStrangers) {
  const auto response = problem_response(std::logic_error("/src/secret.cpp:12: broken"));

  EXPECT_EQ(response.status, 500);
  EXPECT_THAT(response.body, ::testing::Not(::testing::HasSubstr("secret")));
}

TEST(Problem, WhatWasFoundMayBeAnyBytes) {
  EXPECT_NO_THROW((void)problem_response(422, {.what = "bad", .found = "\xFF\xFE\0"}));
}

}  // namespace
}  // namespace elrom::serve
