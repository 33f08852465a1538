#include "elrom/ingest/onto_mesh.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

namespace elrom::ingest {
namespace {

CfdCase first_shipped() { return read_el3d(ELROM_SOURCE_DIR "/data/cases/train_000.h5"); }

Coverage coverage_of(const CfdCase& one, const field::Mesh& mesh) {
  OntoMesh onto_mesh(mesh, 2);
  const auto fields = field::standard_fields();
  (void)onto_mesh.bring(one, one.schema, {fields.begin(), fields.end()});
  return onto_mesh.coverage();
}

TEST(OntoMesh, MeshesOfOneFurnaceReachEachOtherHoweverCoarseTheyAre) {
  for (const auto& mesh : {field::make_furnace_mesh({}, 5, 6, 10), field::make_furnace_mesh({}, 10, 21, 33),
                           field::make_furnace_mesh({}, 20, 42, 66)}) {
    const auto coverage = coverage_of(first_shipped(), mesh);

    EXPECT_EQ(coverage.uncovered, 0) << mesh.n_planes;
    EXPECT_EQ(coverage.beyond, 0) << mesh.n_planes;
  }
}

TEST(OntoMesh, AScaledMeshLeavesCellsOutOfReach) {
  const auto mesh = field::make_furnace_mesh({}, 10, 21, 33);
  auto small = first_shipped(), large = first_shipped();
  small.centre *= 0.7;
  large.centre *= 1.4;

  EXPECT_GT(coverage_of(small, mesh).uncovered, 0.3);
  EXPECT_EQ(coverage_of(small, mesh).beyond, 0);
  EXPECT_GT(coverage_of(large, mesh).beyond, 0.3);
}

TEST(OntoMesh, AMeshInMillimetresIsRefusedAtOnce) {
  auto one = first_shipped();
  one.centre *= 1000;

  EXPECT_ERROR(InputError, "does not lie on the reduced mesh",
               coverage_of(one, field::make_furnace_mesh({}, 5, 6, 10)));
}

}  // namespace
}  // namespace elrom::ingest
