#include "elrom/particle/document_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::particle {
namespace {

// Velocity component k becomes first + k, or 100 more where the scaled first component is not below 1.
DocumentPart part(double first, double mean = 0, double scale = 1) {
  std::vector<TreeNode> nodes;
  std::vector<TreeGroup> outputs;
  for (int k = 0; k < 6; ++k) {
    const auto root = static_cast<std::int32_t>(nodes.size());
    outputs.push_back({first + k, {root}});
    nodes.push_back({0, root + 1, 1});
    nodes.push_back({-1, 0, 0});
    nodes.push_back({-1, 0, 100});
  }
  return {{Eigen::VectorXd::Constant(6, mean), Eigen::VectorXd::Constant(6, scale)}, {6, nodes, outputs}};
}

// Along x, sphere 2 at rest in front of sphere 1.
Pairs head_on_at(const std::vector<double>& speeds) {
  Pairs pairs(speeds.size());
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    pairs.before.velocity_1(row, 0) = speeds[i];
    pairs.normal(row, 0) = 1;
  }
  pairs.diameter_1 = 315e-6, pairs.diameter_2 = 475e-6;
  pairs.density_1 = 1000, pairs.density_2 = 2000;
  return pairs;
}

TEST(DocumentModel, ImpulsesBringTheVelocitiesThatItsTreesGive) {
  const DocumentModel model(part(10));
  const auto pairs = head_on_at({0.5});
  Impulses impulses;

  model.impulses(pairs, impulses);

  const double m1 = M_PI / 6 * 1000 * std::pow(315e-6, 3), m2 = M_PI / 6 * 2000 * std::pow(475e-6, 3);
  EXPECT_NEAR(impulses.linear_1(0, 0), m1 * (10 - 0.5), 1e-12 * m1);
  EXPECT_NEAR(impulses.linear_1(0, 1), m1 * 11, 1e-12 * m1);
  EXPECT_NEAR(impulses.linear_2(0, 2), m2 * 15, 1e-12 * m2);
  EXPECT_TRUE((impulses.angular_1 == 0).all() && (impulses.angular_2 == 0).all());
}

TEST(DocumentModel, InputsAreScaledAsInTraining) {
  const DocumentModel model(part(0, 3, 2));  // the threshold lies at 3 + 2 * 1 m/s

  const Table after = model.velocities_after(six_velocities(head_on_at({4.9, 5.1}).before));

  EXPECT_EQ(after(0, 0), 0);
  EXPECT_EQ(after(1, 0), 100);
}

TEST(DocumentModel, BothSpheresMustBeSlowForTheLowPart) {
  const DocumentModel model(part(0), DocumentModel::Low{2, part(50)});
  Table velocities = Table::Zero(4, 6);
  velocities.row(0) << -1, 1, 1, 0, 0, 2;      // 1.73 and 2
  velocities.row(1) << -1, 1, 1, 0, 0, 2.001;  // sphere 2 is fast
  velocities.row(2) << -1.5, 1, 1, 0, 0, 0;    // sphere 1 is

  const Table after = model.velocities_after(velocities);

  EXPECT_EQ(after(0, 5), 55);
  EXPECT_EQ(after(1, 5), 5);
  EXPECT_EQ(after(2, 5), 5);
  EXPECT_EQ(after(3, 0), 50) << "at rest";
}

TEST(DocumentModel, PairsThatPartOrAreNotFiniteGetNoImpulse) {
  const DocumentModel model(part(10));
  auto pairs = head_on_at({0.5, -0.5, 0, NAN, INFINITY, 0.5, 0.5});
  pairs.diameter_2[5] = NAN;
  pairs.before.velocity_2(6, 1) = INFINITY;
  Impulses impulses;

  model.impulses(pairs, impulses);

  EXPECT_NE(impulses.linear_1(0, 0), 0);
  EXPECT_TRUE((impulses.linear_1.bottomRows(6) == 0).all());
  EXPECT_TRUE((impulses.linear_2.bottomRows(6) == 0).all());
}

TEST(DocumentModel, AFileKeepsBothParts) {
  const test::TemporaryFolder folder;
  for (const bool with_low : {false, true}) {
    const DocumentModel model(part(1, 0.5, 3),
                              with_low ? std::optional(DocumentModel::Low{2, part(7, 0.1)}) : std::nullopt);
    io::TensorFile file;
    model.write(file);
    file.write(folder / "c.elrom");
    const auto back = DocumentModel::read(io::TensorFile::open(folder / "c.elrom"));

    const Table velocities = six_velocities(head_on_at({0.5, 1.5, 3, 5}).before);
    EXPECT_TRUE((back->velocities_after(velocities) == model.velocities_after(velocities)).all());
    EXPECT_EQ(back->text(), model.text());
  }
}

TEST(DocumentModel, PartsThatDoNotFitAreRefused) {
  const auto with_scale = [](double scale) { return part(0, 0, scale); };
  EXPECT_ERROR(InputError, "cannot be used", DocumentModel(with_scale(0)));
  EXPECT_ERROR(InputError, "cannot be used", DocumentModel(with_scale(NAN)));
  const DocumentPart five{{Eigen::VectorXd::Zero(6), Eigen::VectorXd::Ones(6)},
                          {6, {{-1, 0, 1}}, {{0, {0}}}}};
  EXPECT_ERROR(InputError, "6 inputs, 1 outputs", DocumentModel(five));
  EXPECT_ERROR(InputError, "greatest speed", DocumentModel(part(0), DocumentModel::Low{0, part(0)}));
  io::TensorFile file;
  DocumentModel(part(0), DocumentModel::Low{2, part(0)}).write(file);
  file.set_text("document/low_speed", "slow");
  EXPECT_ERROR(InputError, "greatest speed", DocumentModel::read(file));
}

}  // namespace
}  // namespace elrom::particle
