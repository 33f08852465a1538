#include "elrom/ingest/judge_fields.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/ingest/check.hpp"
#include "elrom/model/prediction_file.hpp"
#include "support/sample_run.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::ingest {
namespace {

/// A shipped case as a simulation sends it, on the CFD's own mesh.
struct Sent {
  test::TemporaryFolder folder;
  CfdCase one = read_el3d(ELROM_SOURCE_DIR "/data/cases/train_000.h5");
  field::Mesh mesh = make_mesh();
  field::Furnace furnace = field::read_furnace(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml");
  std::string bundle_digest;

  [[nodiscard]] field::Mesh make_mesh() const {
    auto layers = *layers_of(one);
    layers.points = one.centre;  // a point a cell: nobody looks at corners here
    layers.corners.clear();
    for (Eigen::Index i = 0; i < one.centre.rows(); ++i)
      layers.corners.insert(layers.corners.end(), 8, static_cast<std::int32_t>(i));
    return layers;
  }
  [[nodiscard]] std::filesystem::path write() const {
    model::PredictionFrame frame{model::Extent(mesh, mesh.n_planes)};
    frame.fields = one.fields;
    frame.schema = one.schema;
    frame.mesh_digest = "m";
    frame.bundle_digest = bundle_digest;
    frame.method = "simulation";
    const std::span values(one.values.data(), static_cast<std::size_t>(one.values.size()));
    const model::Assessment assessment;
    model::write_prediction(
        frame, {.inputs = &one.record.inputs, .assessment = &assessment, .values = values}, folder / "a.hdf");
    return folder / "a.hdf";
  }
  void scale(const std::string& field, float factor) {
    for (std::size_t f = 0; f < one.fields.size(); ++f)
      if (one.fields[f].name == field) one.values.row(static_cast<Eigen::Index>(f)) *= factor;
  }
};

TEST(JudgeFields, ASimulationReadsBackAsACase) {
  const Sent sent;

  const auto read = read_case(sent.write());

  EXPECT_EQ(read.record.inputs.name, sent.one.record.inputs.name);
  EXPECT_EQ(read.record.inputs.load, sent.one.record.inputs.load);
  EXPECT_EQ(read.record.inputs.values, sent.one.record.inputs.values);
  EXPECT_EQ(read.schema.names(), sent.one.schema.names());
  ASSERT_EQ(read.fields.size(), sent.one.fields.size());
  for (std::size_t f = 0; f < read.fields.size(); ++f) {
    const auto sent_as = std::ranges::find(sent.one.fields, read.fields[f].name, &field::FieldInfo::name);
    ASSERT_NE(sent_as, sent.one.fields.end());
    EXPECT_EQ(read.values.row(static_cast<Eigen::Index>(f)),
              sent.one.values.row(sent_as - sent.one.fields.begin()));
  }
}

TEST(JudgeFields, AModelDoesNotLearnFromItsPredictions) {
  Sent sent;
  sent.bundle_digest = std::string(64, 'c');

  EXPECT_ERROR(InputError, "a model's prediction is no case to learn from", read_case(sent.write()));
}

TEST(JudgeFields, PartsOfTheFurnaceAreNoCase) {
  const test::TemporaryFolder folder;
  model::Excerpt excerpt;
  excerpt.profile = true;
  test::SampleRun sample(excerpt);
  sample.frame.bundle_digest.clear();
  sample.values.assign(6, 1.0F);
  model::write_prediction(sample.frame, sample.prediction(), folder / "a.hdf");

  EXPECT_ERROR(InputError, "fields of a part of the furnace", read_case(folder / "a.hdf"));
  EXPECT_NO_THROW(judge_physics_of(folder / "a.hdf", sample.mesh, std::nullopt));
}

TEST(JudgeFields, ASoundFilePasses) {
  const Sent sent;

  EXPECT_NO_THROW(judge_physics_of(sent.write(), sent.mesh, sent.furnace));
}

TEST(JudgeFields, CellsThatLieElsewhereAreRefused) {
  Sent sent;
  const auto file = sent.write();
  sent.mesh.centre(7, 0) += 1;

  EXPECT_ERROR(InputError, "cells lie elsewhere", judge_physics_of(file, sent.mesh, sent.furnace));
}

TEST(JudgeFields, WhatPhysicsForbidsIsRefusedWithTheReason) {
  Sent turned;
  turned.scale("gas_velocity_z", -1);
  EXPECT_ERROR(InputError, "gas_velocity_z", judge_physics_of(turned.write(), turned.mesh, turned.furnace));

  Sent light;
  light.scale("solid_volume_fraction", 0.1F);
  EXPECT_ERROR(InputError, "solid", judge_physics_of(light.write(), light.mesh, light.furnace));
}

}  // namespace
}  // namespace elrom::ingest
