#include "elrom/ingest/generate.hpp"

#include <gmock/gmock.h>

#include <numeric>
#include <set>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::ingest {
namespace {

class Generating : public ::testing::Test {
 protected:
  field::SnapshotStore make() const {
    generate(options_, silent_log());
    return field::SnapshotStore::open(options_.store);
  }
  static std::vector<std::size_t> all(const field::SnapshotStore& store) { return store.find("*"); }
  test::TemporaryFolder folder_;
  GenerateOptions options_{.store = folder_ / "g.h5", .n_cases = 20, .n_planes = 33, .n_columns = 84};
};

TEST_F(Generating, GivesTheSizesAskedFor) {
  options_.n_fields = 11;
  options_.n_inputs = 30;
  options_.n_held_out = 3;

  const auto store = make();

  EXPECT_EQ(store.n_cases(), 23U);
  EXPECT_EQ(store.find("load_*").size(), 3U);
  EXPECT_EQ(store.mesh().n_planes, 33U);
  EXPECT_EQ(store.mesh().n_columns, 84U);
  EXPECT_EQ(store.fields().back().name, "tracer_02");
  EXPECT_EQ(store.schema().size(), 30U);
  EXPECT_EQ(store.schema()[29].name, "auxiliary_04");
  for (const auto& field : store.fields())
    EXPECT_TRUE(store.read(field.name, all(store)).allFinite()) << field.name;
}

TEST_F(Generating, OneOfEverythingIsEnough) {
  options_.n_cases = options_.n_planes = options_.n_columns = options_.n_fields = options_.n_inputs = 1;

  const auto store = make();

  EXPECT_TRUE(store.read("solid_velocity_x", all(store)).allFinite());
}

TEST_F(Generating, TheSeedAloneDecides) {
  options_.n_threads = 1;
  make();
  const auto first = base::sha256_file(options_.store);
  std::filesystem::remove(options_.store);
  options_.n_threads = 3;
  make();
  const auto second = base::sha256_file(options_.store);
  std::filesystem::remove(options_.store);
  options_.seed = 2;
  make();

  EXPECT_EQ(first, second);
  EXPECT_NE(base::sha256_file(options_.store), first);
}

TEST_F(Generating, EveryInputIsStratified) {
  const auto store = make();
  const auto inputs = store.inputs(all(store));

  // Inventory does not depend on load: one case in each twentieth of 78 to 122 t.
  const auto column = static_cast<Eigen::Index>(store.schema().index_of("solids_inventory"));
  std::set<long> parts;
  for (Eigen::Index i = 0; i < inputs.rows(); ++i)
    parts.insert(std::lround(std::floor((inputs(i, column) / 1e5 - 0.78) / 0.44 * 20)));
  EXPECT_EQ(parts.size(), 20U);
}

TEST_F(Generating, WeightOfSolidsIsTheInventory) {
  options_.noise = 0;
  const auto store = make();
  const auto fraction = store.read("solid_volume_fraction", all(store));

  for (std::size_t c = 0; c < store.n_cases(); ++c) {
    double weight = 0;
    for (std::size_t i = 0; i < store.mesh().n_cells(); ++i) {
      weight += 2400.0 * store.mesh().volume[i] *
                static_cast<double>(fraction(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(i)));
    }
    const double inventory = store.cases()[c].inputs.values[store.schema().index_of("solids_inventory")];
    EXPECT_NEAR(weight / inventory, 1, 0.01);
  }
}

TEST_F(Generating, FieldsHaveTheShapeOfAFurnace) {
  const auto store = make();
  const auto fraction = store.read("solid_volume_fraction", all(store)),
             pressure = store.read("pressure", all(store));
  const auto rise = store.read("gas_velocity_z", all(store));
  const auto n = static_cast<Eigen::Index>(store.mesh().n_columns),
             n_planes = static_cast<Eigen::Index>(store.mesh().n_planes);

  for (Eigen::Index c = 0; c < fraction.rows(); ++c) {
    const auto plane_mean = [&](const MatrixF& f, Eigen::Index k) {
      return f.row(c).segment(k * n, n).mean();
    };
    EXPECT_GT(plane_mean(fraction, 0), 5 * plane_mean(fraction, n_planes - 1));
    EXPECT_GT(plane_mean(pressure, 0), plane_mean(pressure, n_planes / 2));
    EXPECT_GT(plane_mean(rise, n_planes / 2), 0);
    EXPECT_GE(fraction.row(c).minCoeff(), 0);
    EXPECT_LE(fraction.row(c).maxCoeff(), static_cast<float>(field::packing_limit));
  }
}

TEST_F(Generating, LoadDrivesTheGas) {
  const auto store = make();
  const auto rise = store.read("gas_velocity_z", all(store));

  std::vector<std::size_t> order = all(store);
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return store.cases()[a].inputs.load < store.cases()[b].inputs.load; });

  const auto mean = [&](std::size_t c) { return rise.row(static_cast<Eigen::Index>(c)).mean(); };
  EXPECT_GT(mean(order.back()), 1.2 * mean(order.front()));
}

TEST_F(Generating, RefusesImpossibleSizesAndAnExistingStore) {
  options_.n_fields = 0;
  EXPECT_ERROR(UsageError, "number of fields", generate(options_, silent_log()));
  options_.n_fields = 2;
  make();
  EXPECT_ERROR(UsageError, "already a file", generate(options_, silent_log()));
}

TEST(Generate, CarriesAFurnaceThatFitsItsInputs) {
  test::TemporaryFolder folder;
  generate({.store = folder / "g.h5", .n_cases = 2, .n_planes = 4, .n_columns = 24, .n_inputs = 30},
           silent_log());

  const auto store = field::SnapshotStore::open(folder / "g.h5");

  ASSERT_TRUE(store.furnace().has_value());
  EXPECT_NO_THROW(field::expect_fits(*store.furnace(), store.schema(), "g.h5"));
  EXPECT_TRUE(field::flows_without_opening(*store.furnace(), store.schema()).empty());
  EXPECT_EQ(store.furnace()->held_out.front(), "load_*");
  ASSERT_EQ(store.furnace()->mirrors.size(), 2U);
  for (const auto& mirror : store.furnace()->mirrors)
    EXPECT_NO_THROW((void)field::resolve(mirror, store.schema(), store.mesh())) << mirror.name;
}

}  // namespace
}  // namespace elrom::ingest
