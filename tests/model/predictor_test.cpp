#include "elrom/model/predictor.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <thread>

#include "elrom/base/error.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace {
thread_local std::size_t n_allocations = 0;
}

#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // inlined, the pairs below look unlike to GCC 12
// Counted for this program alone: the contract "allocates
// nothing after the first call" is tested, not believed.
void* operator new(std::size_t size) {
  ++n_allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++n_allocations;
  const auto step = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(step, (size + step - 1) / step * step)) return memory;
  throw std::bad_alloc();
}
// The library's own calls the first of these; a sanitizer's does not.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++n_allocations;
  return std::malloc(size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace elrom::model {
namespace {

using ::testing::HasSubstr;

class PredictorTest : public ::testing::Test {
 protected:
  static constexpr std::size_t n_cells = 5 * 12;
  const test::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "model.elrom";
  const std::vector<double> inputs_ = test::sample_case();

  void SetUp() override { test::sample_bundle().write(path_); }

  [[nodiscard]] std::vector<float> predict(const Selection& selection, int n_threads = 1) const {
    const Predictor predictor(path_, selection);
    std::vector<float> values(predictor.size());
    Predictor::Scratch scratch;
    predictor.predict(inputs_, values, {}, scratch, n_threads);
    return values;
  }
};

TEST_F(PredictorTest, EqualsTheModelsOneByOneInsideTheBounds) {
  const auto values = predict({});
  const auto bundle = test::sample_bundle();
  const std::vector<std::int32_t> planes{0, 1, 2, 3, 4};
  Workspace workspace;

  for (std::size_t i = 0; i < bundle.info.fields.size(); ++i) {
    const auto& info = bundle.info.fields[i];
    std::vector<float> expected(n_cells);
    bundle.models.at(info.name)->predict({inputs_, planes}, expected, {}, workspace);
    for (std::size_t c = 0; c < n_cells; ++c) {
      const float value = values[i * n_cells + c];
      const float low = info.lower ? static_cast<float>(*info.lower) : -INFINITY;
      const float high = info.upper ? static_cast<float>(*info.upper) : INFINITY;
      const bool exclusive = info.unit == "m";
      if (expected[c] > low && expected[c] < high) {
        EXPECT_EQ(value, expected[c]) << info.name << " " << c;
      }
      EXPECT_TRUE((exclusive ? value > low : value >= low) && value <= high) << info.name << " " << value;
    }
  }
}

TEST_F(PredictorTest, AnyThreadCountGivesTheSameBits) {
  const auto one = predict({});

  for (const int n : {2, 3, 16}) EXPECT_EQ(predict({}, n), one) << n << " threads";
}

TEST_F(PredictorTest, TellsOfEachFieldOnceWhenItsValuesAreThere) {
  const auto expected = predict({});
  const Predictor predictor(path_, {});

  for (const int n_threads : {1, 2, 7}) {
    std::vector<float> values(predictor.size());
    std::vector<int> n_told(predictor.fields().size()), n_right(n_told);
    std::atomic<int> n_first = 0;
    Predictor::Scratch scratch;
    predictor.predict(inputs_, values, {}, scratch, n_threads,
                      {.first = [&] { ++n_first; },
                       .ready =
                           [&](std::size_t i) {
                             ++n_told[i];
                             const auto begin = static_cast<std::ptrdiff_t>(i * n_cells);
                             n_right[i] +=
                                 std::equal(values.begin() + begin, values.begin() + begin + n_cells,
                                            expected.begin() + begin);
                           }});
    EXPECT_EQ(n_first, 1);
    EXPECT_THAT(n_told, ::testing::Each(1)) << n_threads << " threads";
    EXPECT_THAT(n_right, ::testing::Each(1)) << n_threads << " threads";
  }
}

TEST_F(PredictorTest, WhatACallerDoesAlongsideMayFail) {
  const Predictor predictor(path_, {});
  std::vector<float> values(predictor.size());
  Predictor::Scratch scratch;

  for (const int n_threads : {1, 2}) {
    EXPECT_THROW(predictor.predict(inputs_, values, {}, scratch, n_threads,
                                   {.first = [] { throw SystemError("disk"); }}),
                 SystemError);
  }
}

TEST_F(PredictorTest, ChosenFieldsAndPlanesAreBitsOfTheWhole) {
  const auto all = predict({});

  const auto some = predict({.fields = {"pressure", "solid_velocity_y"}, .planes = {1, 4}});

  ASSERT_EQ(some.size(), 2U * 2 * 12);
  const std::size_t chosen_fields[] = {1, 6}, chosen_planes[] = {1, 4};
  for (std::size_t f = 0; f < 2; ++f) {
    for (std::size_t p = 0; p < 2; ++p) {
      for (std::size_t c = 0; c < 12; ++c) {
        EXPECT_EQ(some[(f * 2 + p) * 12 + c], all[chosen_fields[f] * n_cells + chosen_planes[p] * 12 + c]);
      }
    }
  }
}

TEST_F(PredictorTest, AllocatesNothingAfterTheFirstCall) {
  const Predictor predictor(path_, {.interval_level = 0.8});
  std::vector<float> values(predictor.size()), width(predictor.size());
  Predictor::Scratch scratch;
  predictor.predict(inputs_, values, width, scratch);

  const std::size_t before = n_allocations;
  for (int i = 0; i < 3; ++i) predictor.predict(inputs_, values, width, scratch);

  EXPECT_EQ(n_allocations, before);
}

TEST_F(PredictorTest, ManyThreadsShareOnePredictor) {
  const auto expected = predict({});
  const Predictor predictor(path_, {});
  std::atomic<int> n_equal = 0;

  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 8; ++t) {
      threads.emplace_back([&] {
        std::vector<float> values(predictor.size());
        Predictor::Scratch scratch;
        for (int i = 0; i < 20; ++i) {
          predictor.predict(inputs_, values, {}, scratch);
          n_equal += values == expected ? 1 : 0;
        }
      });
    }
  }
  EXPECT_EQ(n_equal, 8 * 20);
}

TEST_F(PredictorTest, FarOutsideEverythingStaysFiniteAndInsideTheBounds) {
  const Predictor predictor(path_, {});
  std::vector<float> values(predictor.size());
  Predictor::Scratch scratch;

  for (const double factor : {0.0, -10.0, 10.0, 1e30, 1e300}) {
    std::vector<double> inputs = inputs_;
    for (auto& value : inputs) value *= factor;
    predictor.predict(inputs, values, {}, scratch);
    EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }))
        << factor;
    const auto fraction = std::span(values).last(n_cells);
    EXPECT_THAT(std::vector<float>(fraction.begin(), fraction.end()),
                ::testing::Each(::testing::AllOf(::testing::Ge(0.0F), ::testing::Le(0.65F))));
    EXPECT_EQ(predictor.guard().assess(inputs).verdict, Verdict::outside);
  }
}

TEST_F(PredictorTest, HalfWidthsGrowWithTheLevel) {
  const Predictor narrow(path_, {.interval_level = 0.5}), wide(path_, {.interval_level = 0.9});
  std::vector<float> values(narrow.size()), small(narrow.size()), large(narrow.size());
  Predictor::Scratch scratch;

  narrow.predict(inputs_, values, small, scratch);
  wide.predict(inputs_, values, large, scratch);

  for (std::size_t i = 0; i < small.size(); ++i) ASSERT_LT(small[i], large[i]);
}

TEST_F(PredictorTest, RefusesUnknownFieldsAndPlanes) {
  EXPECT_THROW(Predictor(path_, {.fields = {"presure"}}), UsageError);
  EXPECT_THROW(Predictor(path_, {.planes = {5}}), UsageError);
  EXPECT_THROW(Predictor(path_, {.planes = {-1}}), UsageError);
  EXPECT_THROW(Predictor(path_, {.planes = {2, 1}}), UsageError);
  EXPECT_THROW(Predictor(path_, {.planes = {2, 2}}), UsageError);
}

TEST_F(PredictorTest, RefusesInputsThatAreNotFinite) {
  const Predictor predictor(path_, {});
  std::vector<float> values(predictor.size());
  Predictor::Scratch scratch;
  auto inputs = inputs_;
  inputs[1] = std::nan("");

  try {
    predictor.predict(inputs, values, {}, scratch);
    FAIL();
  } catch (const NumericalError& error) {
    EXPECT_THAT(error.what(), HasSubstr("flow_1"));
  }
}

TEST_F(PredictorTest, OneBuildIsNotTheMeanOfAll) {
  EXPECT_NE(predict({.best_build_only = true}), predict({}));
}

TEST_F(PredictorTest, KeepsPredictingWhileItsBundleIsReplaced) {
  const auto expected = predict({});
  const Predictor predictor(path_, {});

  test::sample_bundle({}, 2).write(path_);
  std::vector<float> values(predictor.size());
  Predictor::Scratch scratch;
  predictor.predict(inputs_, values, {}, scratch);

  EXPECT_EQ(values, expected);
  EXPECT_NE(predict({}), expected);
}

}  // namespace
}  // namespace elrom::model
