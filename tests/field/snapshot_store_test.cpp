#include "elrom/field/snapshot_store.hpp"

#include <cmath>
#include <fstream>
#include <limits>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/units.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::field {
namespace {

using ::testing::ElementsAre;

class Store : public ::testing::Test {
 protected:
  Snapshot snapshot(const std::string& name, float value) const {
    Snapshot s;
    s.record.inputs = {name, 0.5, {value, 300}};
    s.record.source = name + ".h5";
    s.record.averaging_window_s = 24;
    s.fields = MatrixF::Constant(2, static_cast<Eigen::Index>(mesh_.n_cells()), value);
    s.fields(1, 3) = -value;
    return s;
  }
  void write(const std::vector<std::pair<std::string, float>>& cases) const {
    SnapshotWriter writer(path_, mesh_, schema_, fields_);
    for (const auto& [name, value] : cases) writer.add(snapshot(name, value));
    writer.commit();
  }

  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "s.h5";
  Mesh mesh_ = make_furnace_mesh({}, 2, 3, 4);
  InputSchema schema_{{{"primary_air", "kg/s", "t/h"}, {"gas_temperature", "K", "degC"}}};
  std::vector<FieldInfo> fields_{field_info("pressure"), field_info("solid_velocity_z")};
};

TEST_F(Store, GivesBackWhatWasAdded) {
  write({{"a", 1}, {"b", 2}, {"c", 3}});

  const auto store = SnapshotStore::open(path_);
  const std::vector<std::size_t> wanted{2, 0};

  EXPECT_EQ(store.n_cases(), 3U);
  EXPECT_EQ(store.schema(), schema_);
  EXPECT_EQ(store.mesh().digest(), mesh_.digest());
  EXPECT_EQ(store.fields()[1].name, "solid_velocity_z");
  EXPECT_EQ(store.fields()[1].parity, Parity::vector_z);
  EXPECT_EQ(store.cases()[1].source, "b.h5");
  EXPECT_TRUE(store.cases()[1].resampling_error.empty());
  const auto values = store.read("solid_velocity_z", wanted);
  EXPECT_EQ(values.rows(), 2);
  EXPECT_EQ(values(0, 0), 3);
  EXPECT_EQ(values(1, 3), -1);
  EXPECT_EQ(store.inputs(wanted)(0, 0), 3);
}

TEST_F(Store, GrowsByLaterWriters) {
  write({{"a", 1}});
  write({{"b", 2}});

  const auto store = SnapshotStore::open(path_);

  EXPECT_THAT(store.find("*"), ElementsAre(0, 1));
  EXPECT_EQ(store.read("pressure", store.find("b"))(0, 5), 2);
}

TEST_F(Store, BringsUnitsThatNotEveryElromKnows) {
  base::know_unit({"barn_door", "K", 2.5, 100});
  schema_ = InputSchema{{{"primary_air", "kg/s", "t/h"}, {"gas_temperature", "K", "barn_door"}}};
  write({{"a", 1}});
  EXPECT_THAT(io::Hdf5File::open(path_).dataset("inputs/factor").read<double>(),
              ElementsAre(base::unit("t/h").factor, 2.5));
  // As another process would find it, which knows no such unit.
  {
    const auto file = io::Hdf5File::open(path_, io::Hdf5File::Access::edit);
    const auto inputs = file.group("inputs");
    inputs.remove("display_unit");
    inputs.write_texts("display_unit", {"t/h", "barn_gate"});
  }

  const auto store = SnapshotStore::open(path_);

  EXPECT_EQ(store.schema()[1].display_unit, "barn_gate");
  EXPECT_DOUBLE_EQ(base::unit("barn_gate").to_si(10), 125);
}

TEST_F(Store, WithoutCommitTheOldStoreIsUntouched) {
  write({{"a", 1}});
  const auto before = base::sha256_file(path_);
  {
    SnapshotWriter writer(path_, mesh_, schema_, fields_);
    writer.add(snapshot("b", 2));
  }

  EXPECT_EQ(base::sha256_file(path_), before);
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    left.push_back(entry.path().filename());
  EXPECT_THAT(left, ::testing::UnorderedElementsAre("s.h5", ".s.h5.lock"));
}

TEST_F(Store, ClearsAwayWhatAKilledWriterLeft) {
  const auto remains = folder_ / ".s.h5.12345.0.tmp", other = folder_ / ".other.h5.12345.0.tmp";
  for (const auto& path : {remains, other}) std::ofstream(path) << "half";

  write({{"a", 1}});

  EXPECT_FALSE(std::filesystem::exists(remains));
  EXPECT_TRUE(std::filesystem::exists(other));
}

TEST_F(Store, RefusesASecondCaseOfTheSameNameOrContent) {
  write({{"a", 1}});
  SnapshotWriter writer(path_, mesh_, schema_, fields_);

  EXPECT_ERROR(InputError, "case 'a' is already in the store", writer.add(snapshot("a", 2)));
  EXPECT_ERROR(InputError, "case 'b' has the same fields as case 'a'", writer.add(snapshot("b", 1)));
}

TEST_F(Store, RefusesAnotherMeshSchemaOrFieldList) {
  write({{"a", 1}});

  EXPECT_ERROR(InputError, "store of another mesh",
               SnapshotWriter(path_, make_furnace_mesh({}, 3, 2, 4), schema_, fields_));
  EXPECT_ERROR(InputError, "gas_temperature [K] as number 2, expected nothing",
               SnapshotWriter(path_, mesh_, InputSchema({schema_[0]}), fields_));
  EXPECT_ERROR(InputError, "found pressure [Pa] as number 1, expected solid_velocity_z [m/s]",
               SnapshotWriter(path_, mesh_, schema_, {fields_[1], fields_[0]}));
}

TEST_F(Store, RefusesNumbersThatAreNotFinite) {
  SnapshotWriter writer(path_, mesh_, schema_, fields_);
  auto bad_field = snapshot("a", 1);
  bad_field.fields(0, 7) = std::numeric_limits<float>::quiet_NaN();
  auto bad_input = snapshot("b", 1);
  bad_input.record.inputs.values[0] = std::numeric_limits<double>::infinity();

  EXPECT_ERROR(InputError, "case 'a', field pressure", writer.add(bad_field));
  EXPECT_ERROR(InputError, "case 'b'", writer.add(bad_input));
}

Furnace small_furnace() {
  return {.name = "small",
          .solid_density = 2500,
          .packing_limit = 0.5,
          .openings = {{.inputs = "primary_air", .kind = "primary_air", .low_m = 1, .high_m = 2}}};
}

TEST_F(Store, CarriesItsFurnace) {
  fields_.push_back(field_info("solid_volume_fraction"));
  SnapshotWriter(path_, mesh_, schema_, fields_, small_furnace()).commit();

  const auto store = SnapshotStore::open(path_);

  ASSERT_TRUE(store.furnace().has_value());
  EXPECT_EQ(to_toml(*store.furnace()), to_toml(small_furnace()));
  EXPECT_EQ(store.fields()[2].upper, 0.5);
}

TEST_F(Store, KeepsItsFurnaceUntilItIsGivenAnother) {
  SnapshotWriter(path_, mesh_, schema_, fields_, small_furnace()).commit();
  write({{"a", 1}});
  ASSERT_TRUE(SnapshotStore::open(path_).furnace().has_value());
  auto other = small_furnace();
  other.name = "other";

  SnapshotWriter(path_, mesh_, schema_, fields_, other).commit();

  EXPECT_EQ(SnapshotStore::open(path_).furnace()->name, "other");
  EXPECT_EQ(SnapshotStore::open(path_).n_cases(), 1U);
}

TEST_F(Store, OlderOnesHaveNoFurnaceAndCanGetOne) {
  write({{"a", 1}});
  const std::vector<std::int64_t> older{1, 0};
  io::Hdf5File::open(path_, io::Hdf5File::Access::edit).set_integers("format", older);
  EXPECT_FALSE(SnapshotStore::open(path_).furnace().has_value());

  SnapshotWriter(path_, mesh_, schema_, fields_, small_furnace()).commit();

  EXPECT_EQ(SnapshotStore::open(path_).furnace()->name, "small");
  EXPECT_EQ(io::Hdf5File::open(path_).numbers("format"), (std::vector<double>{1, 1}));
}

TEST_F(Store, ABrokenFurnaceIsAnInputErrorWithItsLine) {
  write({{"a", 1}});
  io::Hdf5File::open(path_, io::Hdf5File::Access::edit).write_texts("furnace", {"name = \"x\"\nsolid = 3\n"});

  EXPECT_ERROR(InputError, "s.h5:furnace:2", SnapshotStore::open(path_));
}

TEST_F(Store, CasesTakenOutAgainLeaveTheBytesOfAStoreThatNeverHadThem) {
  write({{"a", 1}});
  const auto begun = folder_ / "begun.h5";
  std::filesystem::copy_file(path_, begun);
  write({{"c", 3}});
  const auto expected = base::sha256_file(path_);
  std::filesystem::rename(begun, path_);

  SnapshotWriter writer(path_, mesh_, schema_, fields_);
  for (const auto& [name, value] : {std::pair("b", 2.0F), std::pair("c", 3.0F), std::pair("d", 4.0F)})
    writer.add(snapshot(name, value));
  writer.leave_out({"b", "d", "a"});  // "a" was there before
  writer.commit();

  EXPECT_EQ(base::sha256_file(path_), expected);
}

TEST_F(Store, RemovedCasesLeaveTheBytesOfAStoreThatNeverHadThem) {
  {
    SnapshotWriter writer(path_, mesh_, schema_, fields_, small_furnace());
    for (const auto& [name, value] : {std::pair("b", 2.0F), std::pair("d", 4.0F)})
      writer.add(snapshot(name, value));
    writer.commit();
  }
  const auto expected = test::read_bytes(path_);
  std::filesystem::remove(path_);
  SnapshotWriter(path_, mesh_, schema_, fields_, small_furnace()).commit();
  write({{"a", 1}, {"b", 2}});
  write({{"c", 3}, {"d", 4}});

  remove_cases(path_, {"a", "c", "not there"});

  EXPECT_EQ(test::read_bytes(path_), expected);
}

TEST_F(Store, ARemovalThatFailsLeavesTheStoreAsItWas) {
  write({{"a", 1}, {"b", 2}});
  const auto before = test::read_bytes(path_);
  {
    const SnapshotWriter other(path_, mesh_, schema_, fields_);
    EXPECT_ERROR(UsageError, "another process is at work here", remove_cases(path_, {"a"}));
  }
  EXPECT_EQ(test::read_bytes(path_), before);
}

TEST_F(Store, OneWriterAtATime) {
  const SnapshotWriter first(path_, mesh_, schema_, fields_);

  EXPECT_ERROR(UsageError, "another process is at work here", SnapshotWriter(path_, mesh_, schema_, fields_));
}

TEST_F(Store, DigestFollowsInputsAndContent) {
  write({{"a", 1}, {"b", 2}});
  const auto store = SnapshotStore::open(path_);
  const std::vector<std::size_t> a{0}, b{1}, both{0, 1};

  EXPECT_NE(store.digest(a), store.digest(b));
  EXPECT_NE(store.digest(a), store.digest(both));
  EXPECT_EQ(store.digest(both), SnapshotStore::open(path_).digest(both));
}

TEST_F(Store, UnknownFieldsAreNamedWithTheNearest) {
  write({{"a", 1}});
  const auto store = SnapshotStore::open(path_);

  EXPECT_ERROR(InputError, "did you mean 'pressure'?", store.read("presure", store.find("a")));
  EXPECT_TRUE(store.find("x*").empty());
}

TEST_F(Store, DamageAnywhereIsFoundOnOpeningOrHarmsNothing) {
  write({{"a", 1.25F}, {"b", 2}});
  const auto whole = test::read_bytes(path_);
  const auto values = SnapshotStore::open(path_).read("pressure", std::vector<std::size_t>{0, 1});
  std::size_t n_found = 0;
  for (std::size_t at = whole.size() / 4; at < whole.size(); at += whole.size() / 40) {
    auto bytes = whole;
    for (std::size_t i = at; i < std::min(bytes.size(), at + 64); ++i)
      bytes[i] = static_cast<char>(bytes[i] ^ 0x55);
    test::write_bytes(path_, bytes);
    try {
      const auto store = SnapshotStore::open(path_);
      EXPECT_EQ(store.read("pressure", std::vector<std::size_t>{0, 1}), values) << "byte " << at;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("s.h5"));
      ++n_found;
    }
  }

  EXPECT_GT(n_found, 5U);
}

TEST_F(Store, TheSameCasesGiveTheSameBytes) {
  write({{"a", 1}, {"b", 2}});
  const auto first = base::sha256_file(path_);
  std::filesystem::remove(path_);
  write({{"a", 1}, {"b", 2}});

  EXPECT_EQ(base::sha256_file(path_), first);
}

}  // namespace
}  // namespace elrom::field
