// Lamps in the plane of a surface, and lamps that cross closed solids: finding their place must not lose light.
#include "patchlight/scene/luminaire.h"
#include "patchlight/simulate.h"

#include "scene/repair.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <utility>

namespace patchlight::lamp_places_test {
namespace {

using namespace test;

const Eigen::Affine3d turned_a_little(Eigen::AngleAxisd(0.7, Vector(0.3, 1, -2).normalized()));

// Direct flux on the patches, W.
double direct_flux(const Simulation& simulation) {
  return (simulation.problem.direct_irradiance.col(0) * simulation.problem.area.array()).sum();
}

Request in_patches(std::size_t patches) {
  Request request;
  request.mesh.patches = patches;
  return request;
}

// A room with an isotropic luminaire of 1 W/sr below or in the middle of its ceiling, at the given heights.
Scene room_with_light(double ceiling, double light, const Eigen::Affine3d& placing) {
  Scene scene = moved(with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 3, ceiling), true), placing);
  scene.luminaires.resize(1);
  scene.luminaires[0].position = placing * Point(2, 1.5, light);
  scene.luminaires[0].light = PointLight{Spectrum::Ones(1)};
  return scene;
}

// The downward half of the flux arrives, 2 pi W, up to rounding, since solid angles are exact. Nothing else is lit: the
// luminaire lies in the plane of the ceiling's outer side.
void expect_half_of_the_flux(const Scene& scene, const char* what) {
  const Simulation simulation = simulate(scene, in_patches(60));
  EXPECT_NEAR(direct_flux(simulation), 2 * std::numbers::pi, 1e-5) << what;
}

// Heights on a grid of 50 mm, which differ by one rounding between the units.
TEST(LuminaireInTheCeiling, LightsTheRoomWhateverRoundingSays) {
  for (int k = 40; k < 70; ++k) {
    const double ceiling = k / 20.0;
    const double by_millimetres = 50 * k * 0.001;
    SCOPED_TRACE(ceiling);
    const auto identity = Eigen::Affine3d::Identity();
    expect_half_of_the_flux(room_with_light(ceiling, by_millimetres, identity), "in millimetres");
    if (k % 5 != 0) continue;
    const double far = std::numeric_limits<double>::infinity();
    expect_half_of_the_flux(room_with_light(ceiling, std::nextafter(ceiling, far), identity), "above by rounding");
    expect_half_of_the_flux(room_with_light(ceiling, std::nextafter(ceiling, -far), identity), "below by rounding");
    expect_half_of_the_flux(room_with_light(ceiling, ceiling, turned_a_little), "turned");
  }
}

// The outer sides face empty, dark space and have no patches.
TEST(LuminaireInTheCeiling, LeavesTheDarkOutsideDark) {
  const Scene scene = room_with_light(2.8, 2800 * 0.001, Eigen::Affine3d::Identity());
  const KeptSides kept = kept_sides(scene, Sides::automatic);
  for (PolygonIndex p = 0; p < 6; ++p) {
    EXPECT_EQ(kept.front[p], 1) << p;
    EXPECT_EQ(kept.back[p], 0) << p;
  }
}

// Nine closed rooms in a square on a grid of 3 m, 0.2 m apart.
Scene nine_rooms() {
  Scene scene = empty_scene({grey(0.5), grey(0, 10)});
  for (int x = 0; x < 3; ++x) {
    for (int y = 0; y < 3; ++y) {
      const Point corner(3.0 * x, 3.0 * y, 0);
      scene = with_box(std::move(scene), corner, corner + Vector(2.8, 2.8, 2.5), true);
    }
  }
  return scene;
}

// Mean irradiance of a room's floor, W/m^2. Each room has six polygons, the floor first.
double floor_irradiance(const Simulation& simulation, PolygonIndex room) {
  double flux = 0;
  double area = 0;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    if (simulation.mesh.polygon[i] != 6 * room || simulation.mesh.side[i] != Side::front) continue;
    flux += simulation.problem.area[i] * simulation.solution.irradiance(i, 0);
    area += simulation.problem.area[i];
  }
  return area > 0 ? flux / area : 0;
}

// One luminous ceiling crosses the walls of all nine rooms. Each room is lit as by its own piece of the ceiling, except
// for the lamp's patches that walls cross.
TEST(LampAcrossSolids, ALuminousCeilingLightsEveryRoom) {
  const Quad whole{Point(0.2, 0.2, 2.3), Point(0.2, 8.6, 2.3), Point(8.6, 8.6, 2.3), Point(8.6, 0.2, 2.3)};
  const Quad piece{Point(3, 3, 2.3), Point(3, 5.8, 2.3), Point(5.8, 5.8, 2.3), Point(5.8, 3, 2.3)};
  Request request;
  request.mesh.max_edge = 0.8;
  const double expected = floor_irradiance(simulate(with_quad(nine_rooms(), piece, 1), request), 4);
  for (const double metres : {1.0, 1000.0}) {
    const Eigen::Affine3d placing = turned_a_little * Eigen::Scaling(metres);
    request.mesh.max_edge = 0.8 * metres;
    const Simulation found = simulate(moved(with_quad(nine_rooms(), whole, 1), placing), request);
    EXPECT_NEAR(floor_irradiance(found, 4) / expected, 1, 0.05) << metres;
    for (const PolygonIndex room : {1U, 3U, 5U, 7U}) {
      EXPECT_NEAR(floor_irradiance(found, room) / floor_irradiance(found, 1), 1, 0.02) << room;
      EXPECT_NEAR(floor_irradiance(found, room) / expected, 1, 0.15) << room;
    }
    for (const PolygonIndex room : {0U, 2U, 6U, 8U})
      EXPECT_NEAR(floor_irradiance(found, room) / floor_irradiance(found, 0), 1, 0.02) << room;
  }
}

// A tube along x with eight sides, fronts outward, from one point to another.
Scene with_tube(Scene scene, const Point& from, const Point& to, double radius) {
  const auto on_ring = [&](const Point& centre, int k) {
    const double angle = std::numbers::pi * k / 4;
    return Point(centre + radius * Vector(0, std::cos(angle), std::sin(angle)));
  };
  std::vector<Point> first, last;
  for (int k = 0; k < 8; ++k) {
    scene =
        with_quad(std::move(scene), {on_ring(from, k), on_ring(from, k + 1), on_ring(to, k + 1), on_ring(to, k)}, 1);
    first.push_back(on_ring(from, -k));
    last.push_back(on_ring(to, k));
  }
  return with_polygon(with_polygon(std::move(scene), first, 1), last, 1);
}

// A tube whose corners lie in the outer two of three rooms, and the centroids of its triangles between them.
TEST(LampAcrossSolids, ATubeLightsTheRoomInTheMiddle) {
  Scene scene = empty_scene({grey(0.5), grey(0, 10)});
  for (const auto& [from, to] : {std::pair{0.0, 1.9}, {2.3, 3.4}, {3.8, 5.6}})
    scene = with_box(std::move(scene), Point(from, 0, 0), Point(to, 2, 2), true);
  scene = with_tube(std::move(scene), Point(0.5, 1, 1.7), Point(5.3, 1, 1.7), 0.02);
  for (const double metres : {1.0, 0.001}) {
    const KeptSides kept = kept_sides(moved(scene, turned_a_little * Eigen::Scaling(metres)), Sides::automatic);
    for (PolygonIndex p = 0; p < 18; ++p) EXPECT_EQ(kept.front[p], 1) << p;
    EXPECT_EQ(kept.dark_solids.size(), 1U) << "the tube itself is dark inside";
  }
}

// A globe above the ceiling, whose lowest 3 mm reach into the room.
TEST(LampAcrossSolids, ABallLightsWhatItReachesInto) {
  Scene scene = moved(with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2.5), true), turned_a_little);
  scene.luminaires.resize(1);
  scene.luminaires[0].position = turned_a_little * Point(2, 1.5, 2.597);
  scene.luminaires[0].light = SphericalLamp{0.1, Spectrum::Ones(1)};
  const KeptSides kept = kept_sides(scene, Sides::automatic);
  for (PolygonIndex p = 0; p < 6; ++p) EXPECT_EQ(kept.front[p], 1) << p;
  EXPECT_EQ(kept.back[1], 1) << "the roof";
}

}  // namespace
}  // namespace patchlight::lamp_places_test
