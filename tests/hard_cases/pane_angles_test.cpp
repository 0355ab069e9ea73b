// Transmittance of panes by the angle of incidence.
#include "patchlight/gather/gather.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/exchange_areas.h"

#include "light/pane.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::pane_angles_test {
namespace {

using namespace test;

Material glass(double transmittance) {
  Material material = grey(0);
  material.transmittance = Spectrum::Constant(1, transmittance);
  return material;
}

// Degrees from the pane's normal.
class LampBehindAPane : public testing::TestWithParam<double> {};

TEST_P(LampBehindAPane, LightsAsFresnelSays) {
  // A sensor faces a square lamp with B = 10 on its axis, 2 m / cos away, through a pane: 10 F T(cos). The lamp is 1/50
  // of the distance wide. Averaging over it changes T by its second derivative, about 10, times 0.01^2 / 6: 0.05 % of
  // T.
  const double angle = GetParam() * std::numbers::pi / 180;
  const double cosine = std::cos(angle);
  const Vector way(std::sin(angle), 0, cosine);
  const Vector across(cosine, 0, -std::sin(angle));
  const double distance = 2 / cosine;
  const double half = 0.01 * distance;
  Scene scene = empty_scene({grey(0, 10), glass(0.8)});
  const Vector u = half * across, v = half * Vector::UnitY();
  scene = with_quad(std::move(scene), {Point(-u - v), Point(u - v), Point(u + v), Point(-u + v)});
  scene = with_quad(std::move(scene), {Point(-90, -90, 1), Point(90, -90, 1), Point(90, 90, 1), Point(-90, 90, 1)}, 1);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 60);
  Field radiosity = Field::Zero(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) radiosity(i, 0) = mesh.polygon[i] == 0 ? 10 : 0;
  const std::vector<Sensor> sensor{{Point(distance * way), -way}};
  const Occluder occluder(scene, Occluder::Blockers::all);
  const double found = gather_irradiance(mesh, radiosity, occluder, sensor).irradiance(0, 0);
  // The form factor to a square on the axis, four times Howell B-1.
  const double x = half / distance;
  const double F = 4 / std::numbers::pi * x / std::sqrt(1 + x * x) * std::atan(x / std::sqrt(1 + x * x));
  const double expected = 10 * F * transmittance(pane_of(1.52, 0.8), cosine);
  EXPECT_NEAR(found, expected, 0.002 * expected);
}

INSTANTIATE_TEST_SUITE_P(HardCases, LampBehindAPane, testing::Values(0.0, 20.0, 40.0, 56.7, 70.0, 80.0));

class RowsBeforeAPane : public testing::TestWithParam<Estimator> {};

TEST_P(RowsBeforeAPane, AddUpToOneWhateverTheAngle) {
  // Two closed cubes with a pane between them, before closure. The end walls see the pane almost straight on, where it
  // transmits 0.05 more than diffuse light; the adjacent walls see it at a slant, where it transmits less. With an
  // absorptance that does not depend on the angle, row sums would be 1 +- 0.2 times that. The scatter of means over a
  // wall is below 0.002.
  Scene scene = empty_scene({grey(0.5), glass(0.8)});
  const std::vector<Quad> first = box_faces(Point(0, 0, 0), Point(1, 1, 1), true);
  const std::vector<Quad> second = box_faces(Point(1, 0, 0), Point(2, 1, 1), true);
  for (const std::size_t k : {0, 1, 2, 4, 5}) scene = with_quad(std::move(scene), first[k]);
  for (const std::size_t k : {0, 1, 2, 3, 4}) scene = with_quad(std::move(scene), second[k]);
  scene = with_quad(std::move(scene), first[3], 1);
  scene.polygons.back().back_material = 1;
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.26);
  const Occluder occluder(scene, Occluder::Blockers::all);
  const int samples = GetParam() == Estimator::hemisphere ? 16384 : 256;
  const Assembly assembly = assemble_exchange_areas(mesh, occluder, {.samples = samples, .estimator = GetParam()});
  const Eigen::VectorXd sums = row_sums(assembly.exchange_areas);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      const PatchRange range = mesh.patches_on(p, side);
      double sum = 0;
      double area = 0;
      for (PatchIndex i = range.begin; i < range.end; ++i) {
        sum += sums[i];
        area += mesh.area[i] * occluder.optics().nonspecular_fraction(p, Side::front);
      }
      if (!(area > 0)) continue;
      EXPECT_NEAR(sum / area, 1, 0.006) << p << ' ' << name_of(side);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(HardCases, RowsBeforeAPane,
                         testing::Values(Estimator::automatic, Estimator::point_polygon, Estimator::hemisphere,
                                         Estimator::contour));

}  // namespace
}  // namespace patchlight::pane_angles_test
