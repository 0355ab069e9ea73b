#include "optics/surface_optics.h"

#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::surface_optics_test {
namespace {

using namespace test;

// A pane of three bands with this transmittance from the front, and a dark back.
Scene coloured_pane(const Spectrum& transmittance) {
  Scene scene = empty_scene({{"glass", rgb(0, 0, 0), rgb(0, 0, 0)}, {"wall", rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}});
  scene.materials[0].transmittance = transmittance;
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)}, 1);
  return with_quad(std::move(scene), {Point(0, 0, 1), Point(1, 0, 1), Point(1, 1, 1), Point(0, 1, 1)}, 0);
}

TEST(SpecularSurface, IsTheMeanOfItsPanesByLuminance) {
  const Spectrum stated = rgb(0.9, 0.5, 0.2);
  const SpecularSurface face(coloured_pane(stated), 1);
  for (const double cosine : {1.0, 0.6, 0.1}) {
    const double expected = 0.2126 * transmittance(pane_of(1.52, 0.9), cosine) +
                            0.7152 * transmittance(pane_of(1.52, 0.5), cosine) +
                            0.0722 * transmittance(pane_of(1.52, 0.2), cosine);
    EXPECT_NEAR(face.transmittance(cosine), expected, 1e-15);
  }
}

TEST(SpecularSurface, TakesHalfOfEachSide) {
  Scene scene = coloured_pane(rgb(0.8, 0.8, 0.8));
  scene.polygons[1].back_material = 1;
  EXPECT_NEAR(SpecularSurface(scene, 1).transmittance(1), 0.4, 1e-14);
}

TEST(SpecularSurface, KeepsOneOverTheHemisphereRelativeToWhatItHolds) {
  // 2 int mu w(mu) dmu = 1 by Simpson's rule, which has the fourth order. The remaining error is that of the 1,024
  // steps.
  const SpecularSurface face(coloured_pane(rgb(0.8, 0.8, 0.8)), 1);
  constexpr int intervals = 4096;
  double sum = 0;
  for (int k = 0; k <= intervals; ++k) {
    const double mu = static_cast<double>(k) / intervals;
    const double weight = k == 0 || k == intervals ? 1 : k % 2 == 1 ? 4 : 2;
    sum += weight / (3 * intervals) * 2 * mu * face.nonspecular_profile(mu);
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_GT(face.nonspecular_fraction(Side::front), 0.2 + 0.05) << "less gets through at an angle";
  EXPECT_NEAR(hemispherical_nonspecular({pane_of(1.52, 0.8)})[0], face.nonspecular_fraction(Side::front), 1e-14);
}

TEST(SpecularSurface, SamplesDirectionsAsItHoldsLight) {
  // The mean of any f over these directions is 2 int f mu w dmu. It is 1 for f = 1 / w, the case of cosine weights, and
  // 2 / 3 for f = mu / w.
  const SpecularSurface face(coloured_pane(rgb(0.8, 0.8, 0.8)), 1);
  constexpr int samples = 100000;
  double one = 0;
  double cosine = 0;
  for (int k = 0; k < samples; ++k) {
    const double mu = face.sample_nonspecular_cosine((k + 0.5) / samples);
    one += 1 / face.nonspecular_profile(mu) / samples;
    cosine += mu / face.nonspecular_profile(mu) / samples;
  }
  EXPECT_NEAR(one, 1, 1e-4);
  EXPECT_NEAR(cosine, 2.0 / 3, 1e-4);
}

TEST(SurfaceOptics, KnowWhichPolygonsAreClear) {
  const SurfaceOptics faces(coloured_pane(rgb(0.8, 0.8, 0.8)));
  EXPECT_FALSE(faces.empty());
  EXPECT_EQ(faces.nonspecular_fraction(0, Side::front), 1);
  EXPECT_EQ(faces.transmittance(0, Vector::UnitZ()), 0);
  EXPECT_EQ(faces.nonspecular_profile(0, Vector::UnitZ()), 1);
  EXPECT_EQ(faces.nonspecular_profile(no_polygon, Vector::UnitZ()), 1);
  EXPECT_NEAR(faces.transmittance(1, -Vector::UnitZ()), 0.8, 1e-14);
  EXPECT_LT(faces.transmittance(1, Vector(0.8, 0, 0.6)), 0.78);
  EXPECT_TRUE(SurfaceOptics(cube_room(0.5, 1)).empty());
}

}  // namespace
}  // namespace patchlight::surface_optics_test
