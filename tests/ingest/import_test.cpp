#include "elrom/ingest/import.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "el3d_case.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "support/recording_log.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::ingest {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Importing : public ::testing::Test {
 protected:
  Importing() { field::write_mesh(options_.mesh, field::make_furnace_mesh({}, 4, 6, 8)); }

  std::filesystem::path write(const test::El3dExport& one) {
    const auto path = folder_ / (one.name + ".h5");
    one.write(path);
    return path;
  }
  std::filesystem::path write(const std::string& name, double shift) {
    test::El3dExport one;
    one.name = name;
    one.shift = shift;
    return write(one);
  }
  ImportSummary take(const std::vector<std::filesystem::path>& files) {
    options_.files = files;
    return import_cases(options_, silent_log());
  }
  // The whole import fails with `message`, and neither a store nor a temporary file is left.
  void expect_refused(const std::vector<std::filesystem::path>& files, const std::string& message) {
    EXPECT_ERROR(InputError, message, take(files));
    EXPECT_FALSE(std::filesystem::exists(options_.store));
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      EXPECT_NE(entry.path().extension(), ".tmp");
  }

  test::TemporaryFolder folder_;
  ImportOptions options_{.mesh = folder_ / "mesh.h5", .store = folder_ / "store.h5"};
};

TEST_F(Importing, FillsAStoreInTheOrderOfTheFiles) {
  const auto summary = take({write("b", 0), write("a", 1)});

  const auto store = field::SnapshotStore::open(options_.store);
  EXPECT_EQ(summary.added.size(), 2U);
  EXPECT_EQ(summary.n_cases, 2U);
  EXPECT_EQ(store.cases()[0].inputs.name, "b");
  EXPECT_EQ(store.fields().size(), 9U);
  EXPECT_EQ(store.mesh().n_cells(), 192U);
  EXPECT_DOUBLE_EQ(store.cases()[0].inputs.values[1], 1073.15);
  EXPECT_EQ(store.cases()[0].source_digest, base::sha256_file(folder_ / "b.h5"));
  EXPECT_EQ(store.cases()[0].resampling_error.size(), 9U);
}

TEST_F(Importing, AddsToAStoreWithoutAMeshFile) {
  take({write("a", 0)});
  options_.mesh.clear();

  const auto summary = take({write("b", 1)});

  EXPECT_EQ(summary.added.size(), 1U);
  EXPECT_EQ(summary.n_cases, 2U);
}

TEST_F(Importing, TheSameFilesGiveTheSameBytes) {
  const auto files = {write("a", 0), write("b", 1)};
  take(files);
  const auto first = base::sha256_file(options_.store);
  std::filesystem::remove(options_.store);
  options_.n_threads = 2;
  take(files);

  EXPECT_EQ(base::sha256_file(options_.store), first);
}

TEST_F(Importing, AFaultInTheLastFileLeavesNothing) {
  test::El3dExport wild;
  wild.name = "wild";
  wild.with_nan = true;

  expect_refused({write("a", 0), write(wild)}, "not finite");
}

TEST_F(Importing, AFaultLeavesAnOldStoreAsItWas) {
  take({write("a", 0)});
  const auto before = base::sha256_file(options_.store);

  EXPECT_ERROR(InputError, "already in the store", take({write("b", 1), write("a", 2)}));
  EXPECT_EQ(base::sha256_file(options_.store), before);
}

TEST_F(Importing, RefusesTheSameResultUnderTwoNames) {
  expect_refused({write("a", 0), write("b", 0)}, "case 'b' has the same fields as case 'a'");
}

TEST_F(Importing, RefusesAMissingField) {
  test::El3dExport less;
  less.leave_out = "pressure";

  expect_refused({write(less)}, "missing field 'pressure' in a.h5");
}

TEST_F(Importing, SuggestsTheNearestBoundaryCondition) {
  test::El3dExport slip;
  slip.name = "slip";
  slip.shift = 1;
  slip.input_names[0] = "primry_air";

  expect_refused({write("a", 0), write(slip)},
                 "unknown boundary condition 'primry_air' in slip.h5; did you mean 'primary_air'?");
}

TEST_F(Importing, RefusesMissingAndDifferentlyMeasuredBoundaryConditions) {
  test::El3dExport fewer, other;
  fewer.name = "fewer";
  fewer.input_names.pop_back();
  fewer.input_units.pop_back();
  fewer.input_values.pop_back();
  other.name = "other";
  other.input_units[0] = "m/s";

  expect_refused({write("a", 1), write(fewer)}, "missing boundary condition 'gas_temperature' in fewer.h5");
  expect_refused({write("a", 1), write(other)}, "wrong unit of 'primary_air' in other.h5: found 'm/s'");
}

TEST_F(Importing, InputsAreMatchedByNameAndConverted) {
  test::El3dExport turned;
  turned.name = "turned";
  turned.shift = 1;
  turned.input_names = {"gas_temperature", "primary_air"};
  turned.input_units = {"K", "t/h"};
  turned.input_values = {1000, 36};

  take({write("a", 0), write(turned)});

  const auto values = field::SnapshotStore::open(options_.store).cases()[1].inputs.values;
  EXPECT_DOUBLE_EQ(values[0], 10);
  EXPECT_DOUBLE_EQ(values[1], 1000);
}

TEST_F(Importing, RefusesAStoreOfAnotherMesh) {
  take({write("a", 0)});
  field::write_mesh(options_.mesh, field::make_furnace_mesh({}, 4, 6, 7));

  EXPECT_ERROR(InputError, "store of another mesh", take({write("b", 1)}));
}

TEST_F(Importing, RefusesACaseInMillimetres) {
  test::El3dExport large;
  large.mesh.centre *= 1000;

  expect_refused({write(large)}, "does not lie on the reduced mesh");
}

TEST_F(Importing, ATableMustAgreeWithTheExport) {
  options_.cases = folder_ / "cases.csv";
  std::ofstream(options_.cases) << "case,primary_air [t/h],gas_temperature [degC]\na,576.01,800\nb,500,800\n";

  EXPECT_EQ(take({write("a", 0)}).added.size(), 1U);
  EXPECT_ERROR(InputError, "'primary_air' of case 'b' differs from its export", take({write("b", 1)}));
}

TEST_F(Importing, CasesCanBeLeftOut) {
  const auto others = take({write("a", 0), write("c", 2)});
  const auto expected = base::sha256_file(options_.store);
  std::filesystem::remove(options_.store);
  options_.leave_out = [] { return std::set<std::string>{"b"}; };

  const auto summary = take({write("a", 0), write("b", 1), write("c", 2)});

  EXPECT_EQ(summary.added.size(), 2U);
  EXPECT_EQ(summary.n_cases, 2U);
  EXPECT_EQ(summary.mean_error, others.mean_error);
  EXPECT_EQ(summary.largest_error, others.largest_error);
  EXPECT_EQ(base::sha256_file(options_.store), expected);
}

TEST_F(Importing, WithoutAnyCaseLeftThereIsNoStore) {
  options_.leave_out = [] { return std::set<std::string>{"a"}; };

  EXPECT_EQ(take({write("a", 0)}).added.size(), 0U);
  EXPECT_FALSE(std::filesystem::exists(options_.store));
}

class ImportingFurnaces : public Importing {
 protected:
  static std::string furnace(const std::string& name, const std::string& inputs = "primary_air") {
    return "name = \"" + name + "\"\n[solids]\ndensity_kg_per_m3 = 2400\npacking_limit = 0.6\n" +
           "[[opening]]\ninputs = \"" + inputs + "\"\nlow_m = 0\nhigh_m = 1\n";
  }
  std::filesystem::path write_furnace(const std::string& file, const std::string& text) {
    base::write_text(folder_ / file, text);
    return folder_ / file;
  }
  std::string take_and_listen(const std::vector<std::filesystem::path>& files) {
    options_.files = files;
    test::RecordingLog log;
    import_cases(options_, log);
    return log.text();
  }
  std::string in_store() const {
    const auto store = field::SnapshotStore::open(options_.store);
    return store.furnace() ? store.furnace()->name : "none";
  }
};

TEST_F(ImportingFurnaces, ReadsTheOneBesideTheMeshAndSaysSo) {
  write_furnace("mesh.toml", furnace("beside"));

  const auto log = take_and_listen({write("a", 0)});

  EXPECT_EQ(in_store(), "beside");
  EXPECT_EQ(field::SnapshotStore::open(options_.store).fields()[8].upper, 0.6);
  EXPECT_THAT(log, HasSubstr("furnace description: " + (folder_ / "mesh.toml").string()));
}

TEST_F(ImportingFurnaces, AFurnaceAloneMakesNoStore) {
  write_furnace("mesh.toml", furnace("beside"));
  options_.leave_out = [] { return std::set<std::string>{"a"}; };

  take({write("a", 0)});

  EXPECT_FALSE(std::filesystem::exists(options_.store)) << "its only case was left out";
}

TEST_F(ImportingFurnaces, WithoutOneThereIsNoneAndThatIsTold) {
  EXPECT_THAT(take_and_listen({write("a", 0)}), HasSubstr("no furnace description"));
  EXPECT_EQ(in_store(), "none");
}

TEST_F(ImportingFurnaces, TheOneThatIsNamedWins) {
  write_furnace("mesh.toml", furnace("beside"));
  options_.furnace = write_furnace("other.toml", furnace("named"));

  take({write("a", 0)});

  EXPECT_EQ(in_store(), "named");
}

TEST_F(ImportingFurnaces, AStoreKeepsItsOwnUntilAnotherIsNamed) {
  write_furnace("mesh.toml", furnace("first"));
  take({write("a", 0)});
  EXPECT_THAT(take_and_listen({write("b", 1)}), Not(HasSubstr("furnace")));  // the same: nothing to say
  write_furnace("mesh.toml", furnace("second"));

  EXPECT_THAT(take_and_listen({write("c", 2)}), HasSubstr("the store keeps its furnace description"));
  EXPECT_EQ(in_store(), "first");
  options_.furnace = folder_ / "mesh.toml";
  EXPECT_EQ(take({}).added.size(), 0U);  // no case is needed for that
  EXPECT_EQ(in_store(), "second");
  EXPECT_EQ(field::SnapshotStore::open(options_.store).n_cases(), 3U);
}

TEST_F(ImportingFurnaces, AWrongOneIsRefusedWithItsPlace) {
  write_furnace("mesh.toml", furnace("f") + "hihg_m = 2\n");
  expect_refused({write("a", 0)}, "mesh.toml:9; did you mean 'high_m'?");

  options_.furnace = write_furnace("named.toml", furnace("f", "primry_air"));
  expect_refused({folder_ / "a.h5"}, "did you mean 'primary_air'?");
}

TEST_F(ImportingFurnaces, OneOfOtherCasesBesideTheMeshIsLeftThere) {
  write_furnace("mesh.toml", furnace("f", "other_air"));

  EXPECT_THAT(take_and_listen({write("a", 0)}),
              HasSubstr("furnace description not used: opening 'other_air'"));
  EXPECT_EQ(in_store(), "none");
}

TEST_F(ImportingFurnaces, FlowsThatNoOpeningNamesAreTold) {
  write_furnace("mesh.toml", furnace("f", "primary_air"));
  test::El3dExport one;
  one.input_names.push_back("fuel");
  one.input_units.push_back("kg/s");
  one.input_values.push_back(3);

  EXPECT_THAT(take_and_listen({write(one)}), HasSubstr("no opening of the furnace for fuel"));
}

TEST_F(Importing, FieldsOfANewStoreCanBeChosen) {
  options_.fields = {"pressure"};

  EXPECT_EQ(take({write("a", 0)}).fields.size(), 1U);
  options_.store = folder_ / "other.h5";
  options_.fields = {"presure"};
  expect_refused({folder_ / "a.h5"}, "did you mean 'pressure'?");
}

TEST_F(Importing, StopsOnRequestWithTheStoreAsItWas) {
  std::stop_source stop;
  stop.request_stop();
  options_.files = {write("a", 0)};

  EXPECT_THROW(import_cases(options_, silent_log(), stop.get_token()), Interrupted);
  EXPECT_FALSE(std::filesystem::exists(options_.store));
}

TEST_F(Importing, ANewStoreNeedsAMesh) {
  options_.mesh.clear();

  EXPECT_ERROR(UsageError, "needs a reduced mesh", take({write("a", 0)}));
}

TEST_F(Importing, ReadsFluentTablesWithBoundaryConditionsFromATable) {
  options_.cases = folder_ / "cases.csv";
  std::ofstream(options_.cases) << "case,primary_air [kg/s]\nplain,160\n";
  std::ofstream table(folder_ / "plain.txt");
  table << "x [m],y [m],z [m]";
  for (const auto& field : field::standard_fields()) table << ',' << field.name << " [" << field.unit << ']';
  const auto mesh = field::make_furnace_mesh({}, 2, 3, 4);
  for (Eigen::Index i = 0; i < mesh.centre.rows(); ++i) {
    table << '\n'
          << mesh.centre(i, 0) << ',' << mesh.centre(i, 1) << ',' << mesh.centre(i, 2)
          << ",1,2,3,4,5,6,7,8e-4,0.1";
  }
  table << '\n';
  table.close();
  options_.fields = {"pressure"};

  take({folder_ / "plain.txt"});

  const auto store = field::SnapshotStore::open(options_.store);
  EXPECT_EQ(store.cases()[0].inputs.values, std::vector<double>{160});
  EXPECT_EQ(store.read("pressure", store.find("plain"))(0, 100), 7);
  options_.cases.clear();
  options_.store = folder_ / "other.h5";
  expect_refused({folder_ / "plain.txt"}, "give them in a table by --cases");
}

}  // namespace
}  // namespace elrom::ingest
