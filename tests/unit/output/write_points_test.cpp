#include "patchlight/base/error.h"

#include "output/vtk/write_vtk.h"
#include "scene/sensor_grid.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

namespace patchlight::write_points_test {
namespace {

SensorGroup points(const std::vector<std::string>& columns) {
  SensorGroup group{.name = "points", .sensors = {}};
  group.sensors.resize(columns.size(), {Point::Zero(), Vector::UnitZ()});
  group.columns = columns;
  return group;
}

Readings readings_of(const Field& irradiance) {
  return {.irradiance = irradiance,
          .standard_error = Field::Zero(irradiance.rows(), irradiance.cols()),
          .bands = usual_bands(irradiance.cols())};
}

TEST(WritePoints, RepeatsTheInputAndAddsIrradiance) {
  const TemporaryFolder folder;
  Field irradiance(2, 3);
  irradiance << 1, 2.5, 1.0 / 3, 0, 1e-12, 123456789;
  Readings readings = readings_of(irradiance);
  readings.standard_error(0, 1) = 0.25;
  const std::vector<SensorGroup> groups = {points({"0.10,0,1e-3,0,0,1", "1,2,3,0,-1,0"})};
  write_points(folder.path() / "points.csv", groups, readings);
  EXPECT_EQ(content_of(folder.path() / "points.csv"),
            "x,y,z,nx,ny,nz,E_r,E_g,E_b,SE_r,SE_g,SE_b,inside_wall,group\n"
            "0.10,0,1e-3,0,0,1,1,2.5,0.333333333,0,0.25,0,0,points\n"
            "1,2,3,0,-1,0,0,1e-12,123456789,0,0,0,0,points\n");
}

TEST(WritePoints, NumbersOtherBandsAndQuotesNames) {
  const TemporaryFolder folder;
  std::vector<SensorGroup> groups = {points({"0,0,0,0,0,1"})};
  groups[0].name = "a \"b\", c";
  write_points(folder.path() / "points.csv", groups, readings_of(Field::Constant(1, 2, 0.5)));
  EXPECT_EQ(content_of(folder.path() / "points.csv"),
            "x,y,z,nx,ny,nz,E_1,E_2,SE_1,SE_2,inside_wall,group\n0,0,0,0,0,1,0.5,0.5,0,0,0,\"a \"\"b\"\", c\"\n");
}

TEST(WritePoints, TakesTheNamesOfTheScenesBands) {
  const TemporaryFolder folder;
  Readings readings = readings_of(Field::Constant(1, 2, 0.5));
  readings.bands[0].name = "450 nm";
  write_points(folder.path() / "points.csv", std::vector{points({"0,0,0,0,0,1"})}, readings);
  EXPECT_NE(content_of(folder.path() / "points.csv").find(",E_450 nm,E_2,SE_450 nm,SE_2,"), std::string::npos);
}

TEST(WritePoints, PhotometricLightsGiveLuxAndAnOvercastSkyDaylightFactors) {
  // 179 lm/W, and half of the light outside.
  const TemporaryFolder folder;
  Readings readings = readings_of(Field::Constant(1, 1, 2));
  readings.photometric = true;
  readings.outside_by_sky = Spectrum::Constant(1, 4);
  const std::vector<SensorGroup> groups = {rectangle_grid(Point(0, 0, 1), {Vector::UnitX(), Vector::UnitY()}, 1)};
  write_points(folder.path() / "points.csv", groups, readings);
  EXPECT_EQ(content_of(folder.path() / "points.csv"),
            "x,y,z,nx,ny,nz,E_1,SE_1,E_v_lx,SE_v_lx,daylight_factor_percent,inside_wall,group\n"
            "0.5,0.5,1,0,0,1,2,0,358,0,50,0,\n");
}

// VTK stores vertices before polygons for any order of the groups. Every cell must still have its own value.
TEST(WritePoints, ParaViewGetsCellsOfGridsAndVerticesWithTheirOwnValues) {
  const TemporaryFolder folder;
  SensorGroup grid = rectangle_grid(Point(0, 0, 1), {Vector(2, 0, 0), Vector(0, 1, 0)}, 1);
  grid.name = "grid";
  SensorGroup single{.name = "single", .sensors = {{Point(7, 8, 9), Vector::UnitX()}}};
  Field irradiance(3, 1);
  irradiance << 1, 2, 3;
  const std::vector<SensorGroup> groups = {grid, single};
  write_points(folder.path() / "points.vtp", groups, readings_of(irradiance));

  const vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder.path() / "points.vtp").c_str());
  reader->Update();
  vtkPolyData& shape = *reader->GetOutput();
  ASSERT_EQ(shape.GetNumberOfVerts(), 1);
  ASSERT_EQ(shape.GetNumberOfPolys(), 2);
  vtkDataArray& values = *shape.GetCellData()->GetArray("irradiance");
  for (const int cell : {0, 1, 2}) {
    std::array<double, 6> box{};
    shape.GetCellBounds(cell, box.data());
    const Point middle = 0.5 * Point(box[0] + box[1], box[2] + box[3], box[4] + box[5]);
    const double expected = middle.x() == 7 ? 3 : middle.x() == 0.5 ? 1 : 2;
    EXPECT_EQ(values.GetTuple1(cell), expected) << "cell " << cell;
  }
}

TEST(WritePoints, FullDiskIsAnError) {
  const TemporaryFolder folder;
  const FullDisk disk(40);
  const std::vector<SensorGroup> groups = {points({"0,0,0,0,0,1"})};
  EXPECT_THROW(write_points(folder.path() / "points.csv", groups, readings_of(Field::Constant(1, 3, 0.5))),
               OutputError);
  EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace patchlight::write_points_test
