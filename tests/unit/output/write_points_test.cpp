#include "patchlight/output/write_points.h"

#include "patchlight/base/error.h"

#include "temporary_folder.h"

#include <gtest/gtest.h>

namespace patchlight {
namespace {

TEST(WritePoints, RepeatsTheInputAndAddsIrradiance) {
  const TemporaryFolder folder;
  Field irradiance(2, 3);
  irradiance << 1, 2.5, 1.0 / 3, 0, 1e-12, 123456789;
  write_points(folder.path() / "points.csv", {"0.10 0 1e-3  0 0 1", "1,2,3,0,-1,0"}, irradiance);
  EXPECT_EQ(content_of(folder.path() / "points.csv"),
            "x,y,z,nx,ny,nz,E_r,E_g,E_b\n"
            "0.10,0,1e-3,0,0,1,1,2.5,0.333333333\n"
            "1,2,3,0,-1,0,0,1e-12,123456789\n");
}

TEST(WritePoints, NumbersOtherBands) {
  const TemporaryFolder folder;
  write_points(folder.path() / "points.csv", {"0 0 0 0 0 1"}, Field::Constant(1, 2, 0.5));
  EXPECT_EQ(content_of(folder.path() / "points.csv"), "x,y,z,nx,ny,nz,E_1,E_2\n0,0,0,0,0,1,0.5,0.5\n");
}

TEST(WritePoints, FullDiskIsAnError) {
  const TemporaryFolder folder;
  const FullDisk disk(40);
  EXPECT_THROW(write_points(folder.path() / "points.csv", {"0 0 0 0 0 1"}, Field::Constant(1, 3, 0.5)), OutputError);
  EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace patchlight
