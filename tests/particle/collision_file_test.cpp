#include <gmock/gmock.h>

#include <functional>

#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/particle/collision_set.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::particle {
namespace {

CollisionSet small_set(std::size_t n = 7) {
  const Protocol protocol{.speed = {0, 2},
                          .diameter_1 = {300e-6, 354e-6},
                          .diameter_2 = {475e-6, 475e-6},
                          .density_2 = 1200,
                          .spin_speed = 0.5};
  const ContactLaw law{.friction = 0.3, .tangential_restitution = 0.7, .stiffness = 1234.5};
  auto set = make_collisions(protocol, law, 18'446'744'073'709'551'615U, 0, n, {}, 100.0);
  set.provenance = {{"made by", "a test"}, {"why", "\u00b5m"}};
  return set;
}

void expect_same(const Motion& a, const Motion& b) {
  EXPECT_TRUE((a.velocity_1 == b.velocity_1).all());
  EXPECT_TRUE((a.velocity_2 == b.velocity_2).all());
  EXPECT_TRUE((a.spin_1 == b.spin_1).all());
  EXPECT_TRUE((a.spin_2 == b.spin_2).all());
}

class CollisionFile : public ::testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "collisions.h5";
  int n_edits_ = 0;

  /// What the reader says of a good file that was changed.
  std::string said_after(const std::function<void(const io::Hdf5File&)>& change) {
    const auto edited = folder_ / ("edited_" + std::to_string(n_edits_++) + ".h5");
    write_collisions(edited, small_set());
    {
      auto file = io::Hdf5File::open(edited, io::Hdf5File::Access::edit);
      change(file);
      file.close();
    }
    try {
      static_cast<void>(read_collisions(edited));
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  }
  /// The same where one value of a dataset is changed.
  std::string said_with(const std::string& dataset, double value) {
    return said_after([&](const io::Hdf5File& file) {
      const auto at = file.dataset(dataset);
      auto values = at.read<double>();
      values.back() = value;
      at.write<double>(values);
    });
  }
};

TEST_F(CollisionFile, KeepsEverything) {
  const auto set = small_set();
  write_collisions(path_, set);
  const auto read = read_collisions(path_);
  EXPECT_EQ(read.protocol, set.protocol);
  EXPECT_EQ(read.law, set.law);
  EXPECT_EQ(read.seed, set.seed);
  EXPECT_EQ(read.speed_cap, set.speed_cap);
  EXPECT_EQ(read.provenance, set.provenance);
  ASSERT_EQ(read.size(), 7u);
  expect_same(read.pairs.before, set.pairs.before);
  expect_same(read.parting.after, set.parting.after);
  EXPECT_TRUE((read.pairs.normal == set.pairs.normal).all());
  EXPECT_TRUE((read.pairs.diameter_1 == set.pairs.diameter_1).all());
  EXPECT_TRUE((read.pairs.diameter_2 == set.pairs.diameter_2).all());
  EXPECT_TRUE((read.pairs.density_1 == set.pairs.density_1).all());
  EXPECT_TRUE((read.pairs.density_2 == set.pairs.density_2).all());
  EXPECT_TRUE((read.pairs.overlap == set.pairs.overlap).all());
  EXPECT_TRUE((read.parting.overlap == set.parting.overlap).all());
  EXPECT_TRUE((read.parting.duration == set.parting.duration).all());
  EXPECT_EQ(read.parting.n_stayed, set.parting.n_stayed);
  EXPECT_EQ(read.parting.pair_steps, set.parting.pair_steps);
}

TEST_F(CollisionFile, KeepsWhatIsLeftOut) {
  const Protocol protocol{.kind = ProtocolKind::document, .approach_time = 1e-5};
  const ContactLaw law{.kind = LawKind::hertz, .youngs_modulus = 1e8, .poisson_ratio = 0.25};
  write_collisions(path_, make_collisions(protocol, law, 3, 0, 4, {}));
  const auto read = read_collisions(path_);
  EXPECT_EQ(read.protocol, protocol);
  EXPECT_EQ(read.law, law);
  EXPECT_EQ(read.speed_cap, std::nullopt);
  EXPECT_TRUE(read.provenance.empty());
}

TEST_F(CollisionFile, SameContentSameBytes) {
  write_collisions(path_, small_set());
  write_collisions(folder_ / "again.h5", small_set());
  EXPECT_TRUE(test::read_bytes(path_) == test::read_bytes(folder_ / "again.h5"));
}

TEST_F(CollisionFile, EveryDatasetHasAUnit) {
  write_collisions(path_, small_set());
  const auto file = io::Hdf5File::open(path_);
  std::map<std::string, std::string> units;
  for (const std::string group : {"before", "after", "pair", "contact"})
    for (const auto& name : file.group(group).names())
      units[group + "/" + name] = file.dataset(group + "/" + name).text("unit");
  EXPECT_EQ(units.size(), 16u);
  EXPECT_EQ(units["before/velocity_1"], "m/s");
  EXPECT_EQ(units["after/spin_2"], "rad/s");
  EXPECT_EQ(units["pair/density_1"], "kg/m3");
  EXPECT_EQ(units["contact/duration"], "s");
}

// Rows are pairs: what a script reads as velocity_1[i] is that of pair i.
TEST_F(CollisionFile, VectorsLieInRows) {
  const auto set = small_set();
  write_collisions(path_, set);
  const auto values = io::Hdf5File::open(path_).dataset("after/velocity_2").read<double>();
  EXPECT_EQ(values[3 * 4 + 1], set.parting.after.velocity_2(4, 1));
}

TEST_F(CollisionFile, RefusesValuesThatNoCollisionHas) {
  EXPECT_EQ(said_after([](const io::Hdf5File&) {}), "nothing");
  for (const auto* name : {"before/velocity_1", "before/spin_2", "after/velocity_2", "after/spin_1"})
    EXPECT_THAT(said_with(name, NAN), testing::HasSubstr("not finite")) << name;
  EXPECT_THAT(said_with("pair/diameter_2", INFINITY), testing::HasSubstr("not finite"));
  EXPECT_THAT(said_with("pair/diameter_1", 0), testing::HasSubstr("not positive"));
  EXPECT_THAT(said_with("pair/density_2", -1), testing::HasSubstr("not positive"));
  EXPECT_THAT(said_with("pair/density_1", -1), testing::HasSubstr("found -1 as number 7"));
  EXPECT_THAT(said_with("pair/diameter_1", 1e150), testing::HasSubstr("no finite mass"));
  EXPECT_THAT(said_with("pair/diameter_2", 1e-150), testing::HasSubstr("no finite mass"));
  EXPECT_THAT(said_with("pair/normal", 2), testing::HasSubstr("no unit vector"));
  EXPECT_THAT(said_with("pair/overlap", -1e-9), testing::HasSubstr("negative overlap"));
  EXPECT_THAT(said_with("contact/overlap", -1e-9), testing::HasSubstr("negative overlap"));
  EXPECT_THAT(said_with("contact/duration", -1e-9), testing::HasSubstr("negative duration"));
}

TEST_F(CollisionFile, RefusesSettingsThatNobodyCouldGive) {
  const auto with_number = [&](const std::string& group, const std::string& name, double value) {
    return said_after([&](const io::Hdf5File& file) { file.group(group).set_number(name, value); });
  };
  EXPECT_THAT(with_number("law", "restitution", 1.5), testing::HasSubstr("restitution"));
  EXPECT_THAT(with_number("law", "stiffness", NAN), testing::HasSubstr("stiffness"));
  EXPECT_THAT(with_number("law", "tangential_restitution", -1), testing::HasSubstr("restitution"));
  EXPECT_THAT(with_number("protocol", "speed_low", 3), testing::HasSubstr("speeds"));
  EXPECT_THAT(with_number("protocol", "approach_time", 1), testing::HasSubstr("overlapped"));
  EXPECT_THAT(with_number("/", "speed_cap", 0), testing::HasSubstr("speed cap"));
  EXPECT_THAT(with_number("contact", "stayed", 8), testing::HasSubstr("stayed"));
  EXPECT_THAT(with_number("contact", "steps", NAN), testing::HasSubstr("steps"));
  const auto with_text = [&](const std::string& group, const std::string& name, const std::string& text) {
    return said_after([&](const io::Hdf5File& file) { file.group(group).set_text(name, text); });
  };
  EXPECT_THAT(with_text("law", "name", "herz"), testing::HasSubstr("did you mean 'hertz'"));
  EXPECT_THAT(with_text("protocol", "name", "genral"), testing::HasSubstr("did you mean 'general'"));
  EXPECT_THAT(with_text("/", "seed", "-1"), testing::HasSubstr("no whole number"));
  EXPECT_THAT(with_text("/", "provenance_names", "one"), testing::HasSubstr("differ in size"));
}

TEST_F(CollisionFile, RefusesShapesThatDoNotFit) {
  const auto with_shape = [&](const std::string& name, const io::Shape& shape) {
    return said_after([&](const io::Hdf5File& file) {
      file.remove(name);
      std::size_t n = 1;
      for (const auto size : shape) n *= size;
      file.write<double>(name, std::vector<double>(n, 1.0), shape);
    });
  };
  EXPECT_THAT(with_shape("before/velocity_1", {3, 7}), testing::HasSubstr("found 3 x 7, expected 7 x 3"));
  EXPECT_THAT(with_shape("pair/normal", {7}), testing::HasSubstr("wrong shape"));
  EXPECT_THAT(with_shape("contact/duration", {6}), testing::HasSubstr("expected 7"));
  EXPECT_THAT(with_shape("pair/diameter_1", {0}), testing::HasSubstr("no row of pairs"));
  EXPECT_THAT(with_shape("pair/diameter_1", {7, 1}), testing::HasSubstr("found 7 x 1"));
  EXPECT_THAT(said_after([](const io::Hdf5File& file) { file.remove("after/spin_1"); }),
              testing::HasSubstr("spin_1"));
}

TEST_F(CollisionFile, RefusesFilesOfOthers) {
  EXPECT_THAT(said_after([](const io::Hdf5File& file) { io::write_kind(file, io::kinds::mesh); }),
              testing::HasSubstr("found elrom-mesh, expected elrom-collisions"));
  folder_.write("text.h5", "no HDF5");
  EXPECT_ERROR(InputError, "text.h5", read_collisions(folder_ / "text.h5"));
  EXPECT_ERROR(InputError, "none.h5", read_collisions(folder_ / "none.h5"));
}

TEST_F(CollisionFile, CutFilesAreRefused) {
  write_collisions(path_, small_set(50));
  const auto bytes = test::read_bytes(path_);
  for (std::size_t part = 0; part < 8; ++part) {
    const auto cut = folder_ / ("cut_" + std::to_string(part) + ".h5");
    test::write_bytes(cut, bytes.substr(0, bytes.size() * part / 8));
    EXPECT_THROW(static_cast<void>(read_collisions(cut)), InputError) << part;
  }
}

}  // namespace
}  // namespace elrom::particle
