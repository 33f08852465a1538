#include "elrom/particle/collision_model.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "elrom/particle/chebyshev.hpp"
#include "elrom/particle/exact_model.hpp"
#include "elrom/particle/frame_model.hpp"
#include "particle/pairs_for_tests.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::particle {
namespace {

CollisionBundle frame_bundle() {
  const ContactLaw law{.kind = LawKind::hertz,
                       .restitution = 0.8,
                       .friction = 0.25,
                       .youngs_modulus = 2e9,
                       .poisson_ratio = 0.4};
  MatrixD coefficients(3, 1);
  coefficients << 1.5, 0.2, 0.2;
  auto regressor = std::make_shared<Chebyshev>(
      Chebyshev::Shape{.n_inputs = 2, .n_outputs = 3, .degree_x = 0, .degree_y = 0},
      std::vector<double>{0, 1}, std::vector<double>{0, 0}, std::vector<double>{1, 1}, coefficients);
  return {.model = std::make_shared<FrameModel>(law, regressor, 0.3),
          .protocol = {.speed = {1, 7}, .diameter_1 = {1e-4, 2e-4}, .density_2 = 2500, .spin_speed = 3},
          .law = law,
          .provenance = {{"pairs", "60000"}},
          .accuracy_json = "{\"a\":1}"};
}

TEST(CollisionBundle, ComesBackFromItsFile) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "c.elrom";
  const auto bundle = frame_bundle();
  bundle.write(path);
  const auto back = CollisionBundle::read(path);
  EXPECT_EQ(back.law, bundle.law);
  EXPECT_EQ(back.protocol, bundle.protocol);
  EXPECT_EQ(back.provenance, bundle.provenance);
  EXPECT_EQ(back.accuracy_json, bundle.accuracy_json);
  EXPECT_EQ(back.model->text(), "frame, chebyshev");
  const auto pairs = draw_pairs(bundle.protocol, 1, 0, 50);
  EXPECT_TRUE((test::after(*back.model, pairs).spin_2 == test::after(*bundle.model, pairs).spin_2).all());
}

TEST(CollisionBundle, TheExactModelIsItsLaw) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "c.elrom";
  const ContactLaw law{.restitution = 0.7, .friction = 0.1, .tangential_restitution = 0.2, .stiffness = 5};
  CollisionBundle{.model = std::make_shared<ExactModel>(law), .law = law}.write(path);
  const auto back = CollisionBundle::read(path);
  EXPECT_EQ(back.law, law);
  const auto pairs = draw_pairs({}, 1, 0, 50);
  EXPECT_TRUE(
      (test::after(*back.model, pairs).velocity_1 == test::after(ExactModel(law), pairs).velocity_1).all());
}

// What a text of the file says must be a law that somebody could ask for.
TEST(CollisionBundle, RefusesALawThatNoMaterialHas) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "c.elrom";
  for (const std::string law : {R"({"kind":"linear","restitution":7,"friction":0,"stiffness":1})",
                                R"({"kind":"linear"})", "{", "[]"}) {
    io::TensorFile file;
    io::write_kind(file, io::kinds::collision);
    file.set_text("surrogate", "exact");
    file.set_text("law", law);
    file.set_text("protocol", "{}");
    file.set_text("provenance", "{}");
    file.set_text("accuracy", "{}");
    file.write(path);
    EXPECT_THROW((void)CollisionBundle::read(path), InputError) << law;
  }
}

// 2/5 m r^2 and m, by hand: sphere of 1 kg and 2 m diameter.
TEST(Apply, ImpulsesChangeVelocitiesAndSpins) {
  const double density = 1 / sphere_mass(2, 1);
  const auto pairs = test::one_pair({1, 0, 0}, {0, 0, 0}, {1, 0, 0}, 2, 2, density, 2 * density);
  Impulses impulses(1);
  impulses.linear_1(0, 1) = 3;
  impulses.linear_2(0, 1) = 3;
  impulses.angular_1(0, 2) = 0.8;
  const auto after = apply(pairs, impulses);
  EXPECT_NEAR(after.velocity_1(0, 0), 1, 1e-14);
  EXPECT_NEAR(after.velocity_1(0, 1), 3, 1e-14);
  EXPECT_NEAR(after.velocity_2(0, 1), 1.5, 1e-14);
  EXPECT_NEAR(after.spin_1(0, 2), 2, 1e-14);
  EXPECT_EQ(after.spin_2(0, 2), 0);
}

}  // namespace
}  // namespace elrom::particle
