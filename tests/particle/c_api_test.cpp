#include <gmock/gmock.h>

#include <cmath>
#include <sstream>
#include <thread>

#include "elrom/particle/collision.h"
#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/exact_model.hpp"
#include "support/outcome.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::particle {
namespace {

using ::testing::HasSubstr;
using Rows = std::vector<double>;

/// As the C interface takes and gives them.
struct Arrays {
  explicit Arrays(const Pairs& pairs)
      : velocity_1(rows(pairs.before.velocity_1)),
        velocity_2(rows(pairs.before.velocity_2)),
        spin_1(rows(pairs.before.spin_1)),
        spin_2(rows(pairs.before.spin_2)),
        normal(rows(pairs.normal)),
        diameter_1(pairs.diameter_1.begin(), pairs.diameter_1.end()),
        diameter_2(pairs.diameter_2.begin(), pairs.diameter_2.end()),
        density_1(pairs.density_1.begin(), pairs.density_1.end()),
        density_2(pairs.density_2.begin(), pairs.density_2.end()),
        linear_1(3 * pairs.size(), 7),
        linear_2(linear_1),
        angular_1(linear_1),
        angular_2(linear_1) {}

  static Rows rows(const Components& values) {
    Rows result;
    for (Eigen::Index i = 0; i < values.rows(); ++i)
      for (Eigen::Index axis = 0; axis < 3; ++axis) result.push_back(values(i, axis));
    return result;
  }
  int call(const elrom_collision* model) {
    return elrom_collision_impulses(model, diameter_1.size(), velocity_1.data(), velocity_2.data(),
                                    spin_1.data(), spin_2.data(), normal.data(), diameter_1.data(),
                                    diameter_2.data(), density_1.data(), density_2.data(), linear_1.data(),
                                    linear_2.data(), angular_1.data(), angular_2.data());
  }
  Rows velocity_1, velocity_2, spin_1, spin_2, normal, diameter_1, diameter_2, density_1, density_2;
  Rows linear_1, linear_2, angular_1, angular_2;
};

class CollisionCApi : public ::testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const std::string path_ = (folder_ / "collision.elrom").string();
  const ContactLaw law_{.restitution = 0.8, .friction = 0.3, .stiffness = 1e5};
  const Protocol protocol_{.diameter_2 = {300e-6, 475e-6}, .density_2 = 1300, .spin_speed = 2};
  const std::shared_ptr<const CollisionModel> model_ = std::make_shared<ExactModel>(law_);
  elrom_collision* opened_ = nullptr;

  void SetUp() override {
    CollisionBundle{.model = model_, .protocol = protocol_, .law = law_}.write(path_);
    opened_ = elrom_collision_open(path_.c_str());
    ASSERT_NE(opened_, nullptr) << elrom_collision_last_error();
  }
  void TearDown() override { elrom_collision_close(opened_); }

  void expect_the_models(const Pairs& pairs, const Arrays& arrays) const {
    Impulses expected(pairs.size());
    model_->impulses(pairs, expected);
    EXPECT_EQ(arrays.linear_1, Arrays::rows(expected.linear_1));
    EXPECT_EQ(arrays.linear_2, Arrays::rows(expected.linear_2));
    EXPECT_EQ(arrays.angular_1, Arrays::rows(expected.angular_1));
    EXPECT_EQ(arrays.angular_2, Arrays::rows(expected.angular_2));
  }
};

// More pairs than go through the model at once, and one alone.
TEST_F(CollisionCApi, GivesWhatTheModelGives) {
  for (const std::size_t n : {2500, 1, 1024}) {
    const auto pairs = draw_pairs(protocol_, 3, 0, n);
    Arrays arrays(pairs);
    ASSERT_EQ(arrays.call(opened_), 0) << elrom_collision_last_error();
    expect_the_models(pairs, arrays);
    EXPECT_NE(arrays.linear_1[3 * n - 1], 0);
  }
  EXPECT_EQ(elrom_collision_text(opened_), model_->text());
}

TEST_F(CollisionCApi, SpinsAndAngularImpulsesMayBeLeftOut) {
  auto pairs = draw_pairs(protocol_, 3, 0, 50);
  pairs.before.spin_1.setZero();
  pairs.before.spin_2.setZero();
  Arrays a(pairs);
  ASSERT_EQ(
      elrom_collision_impulses(opened_, 50, a.velocity_1.data(), a.velocity_2.data(), nullptr, nullptr,
                               a.normal.data(), a.diameter_1.data(), a.diameter_2.data(), a.density_1.data(),
                               a.density_2.data(), a.linear_1.data(), a.linear_2.data(), nullptr, nullptr),
      0)
      << elrom_collision_last_error();
  Impulses expected(50);
  model_->impulses(pairs, expected);
  EXPECT_EQ(a.linear_1, Arrays::rows(expected.linear_1));
  EXPECT_EQ(a.linear_2, Arrays::rows(expected.linear_2));
}

TEST_F(CollisionCApi, SaysWhatIsWrong) {
  EXPECT_EQ(elrom_collision_open((folder_ / "none.elrom").c_str()), nullptr);
  EXPECT_THAT(elrom_collision_last_error(), HasSubstr("none.elrom"));
  EXPECT_EQ(elrom_collision_open(nullptr), nullptr);
  EXPECT_THAT(elrom_collision_last_error(), HasSubstr("null pointer"));
  folder_.write("text.elrom", "no model");
  EXPECT_EQ(elrom_collision_open((folder_ / "text.elrom").c_str()), nullptr);
  EXPECT_EQ(elrom_collision_text(nullptr), nullptr);

  const auto pairs = draw_pairs(protocol_, 3, 0, 4);
  Arrays sound(pairs);
  EXPECT_EQ(sound.call(nullptr), 2);
  EXPECT_EQ(elrom_collision_impulses(opened_, 1, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
                                     nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr),
            2);
  EXPECT_EQ(elrom_collision_impulses(opened_, 0, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
                                     nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr),
            0);
  const auto refused = [&](Rows Arrays::*array, std::size_t i, double value) {
    Arrays arrays(pairs);
    (arrays.*array)[i] = value;
    EXPECT_EQ(arrays.call(opened_), 3);
    EXPECT_EQ(arrays.linear_1, Rows(12, 7.0));  // nothing is written
    return std::string(elrom_collision_last_error());
  };
  EXPECT_EQ(refused(&Arrays::diameter_2, 2, 0), "no diameter in pair 2, counted from 0: found 0");
  EXPECT_THAT(refused(&Arrays::diameter_1, 0, NAN), HasSubstr("no diameter"));
  EXPECT_THAT(refused(&Arrays::density_1, 3, -1), HasSubstr("no density in pair 3"));
  EXPECT_THAT(refused(&Arrays::density_2, 3, INFINITY), HasSubstr("no density"));
  EXPECT_THAT(refused(&Arrays::normal, 4, 2), HasSubstr("no unit normal; its length in pair 1"));
}

TEST_F(CollisionCApi, VelocitiesThatAreNotFiniteGiveNone) {
  Arrays arrays(draw_pairs(protocol_, 3, 0, 2));
  arrays.velocity_1[1] = NAN;
  ASSERT_EQ(arrays.call(opened_), 0);
  EXPECT_EQ(Rows(arrays.linear_1.begin(), arrays.linear_1.begin() + 3), Rows(3, 0.0));
  EXPECT_NE(arrays.linear_1[3], 0);
}

TEST_F(CollisionCApi, ManyThreadsUseOneModel) {
  const auto pairs = draw_pairs(protocol_, 3, 0, 1500);
  std::vector<Arrays> arrays(4, Arrays(pairs));
  {
    std::vector<std::jthread> threads;
    for (auto& one : arrays)
      threads.emplace_back([&] {
        for (int i = 0; i < 20; ++i) EXPECT_EQ(one.call(opened_), 0);
      });
  }
  for (const auto& one : arrays) expect_the_models(pairs, one);
}

/// Output of a program that ends well.
std::string said(const std::string& command) {
  const auto outcome = test::outcome_of(command);
  EXPECT_EQ(outcome.status, 0) << command;
  return outcome.text;
}

/// The pairs of collision_from_c.c and collision_from_python.py.
Pairs pairs_of_callers() {
  Pairs pairs(3);
  pairs.before.velocity_1 << 1, 0.5, -0.25, 2, 0, 0, -1, 0, 0;
  pairs.before.velocity_2 << -1, 0, 0, 0, 1, 0, 1, 0, 0;
  pairs.before.spin_1 << 0, 0, 500, -300, 0, 0, 0, 0, 0;
  pairs.normal << 1, 0, 0, 0.6, -0.8, 0, 1, 0, 0;
  pairs.diameter_1 = 315e-6;
  pairs.diameter_2 << 475e-6, 315e-6, 475e-6;
  pairs.density_1 << 1000, 1200, 1000;
  pairs.density_2 = 1000;
  return pairs;
}

class OtherLanguages : public CollisionCApi {
 protected:
  void expect_the_models_values(const std::string& output) const {
    Impulses expected(3);
    model_->impulses(pairs_of_callers(), expected);
    std::istringstream stream(output);
    for (Eigen::Index i = 0; i < 3; ++i)
      for (const auto* vectors :
           {&expected.linear_1, &expected.linear_2, &expected.angular_1, &expected.angular_2})
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
          double value = NAN;
          stream >> value;
          EXPECT_EQ(value, (*vectors)(i, axis)) << i << " " << axis;
        }
    EXPECT_NE(expected.linear_1(0, 0), 0);
    EXPECT_NE(expected.angular_1(0, 2), 0);
    EXPECT_EQ(expected.linear_1(2, 0), 0);
  }
};

TEST_F(OtherLanguages, FromC) { expect_the_models_values(said(COLLISION_FROM_C " " + path_)); }

TEST_F(OtherLanguages, FromPythonsCtypes) {
  if (std::system("python3 -c 'import ctypes' 2>/dev/null") != 0) GTEST_SKIP() << "no python3 with ctypes";
  expect_the_models_values(said(
      "python3 " ELROM_SOURCE_DIR "/tests/particle/collision_from_python.py " COLLISION_LIBRARY " " + path_));
}

}  // namespace
}  // namespace elrom::particle
