#include "lighting/sky_openings.h"

#include "form_factor/point_polygon.h"
#include "lighting/direct_irradiance.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight::sky_openings_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

// A square wall at this y, in four faces around a square hole in its middle. It extends `beside` to either side.
Scene with_pierced_wall(Scene scene, double y, double width, double beside) {
  const auto quad = [&](double x0, double x1, double z0, double z1) {
    return Quad{Point(x0, y, z0), Point(x0, y, z1), Point(x1, y, z1), Point(x1, y, z0)};
  };
  const double half = width / 2;
  scene = with_quad(std::move(scene), quad(-beside, beside, -beside, -half));
  scene = with_quad(std::move(scene), quad(-beside, beside, half, beside));
  scene = with_quad(std::move(scene), quad(-beside, -half, -half, half));
  return with_quad(std::move(scene), quad(half, beside, -half, half));
}

// A room of 4 x 4 x 4 m, with a hole in the middle of its wall at y = 0. A wall of 0.2 m has another face with a hole
// in front, and faces line the passage between both.
Scene pierced_room(double width, bool thick) {
  Scene scene = empty_scene({grey(0.5)});
  const std::vector<Quad> faces = box_faces(Point(-2, 0, -2), Point(2, 4, 2), true);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (k != 2) scene = with_quad(std::move(scene), faces[k]);
  }
  scene = with_pierced_wall(std::move(scene), 0, width, 2);
  Sky sky;
  sky.zenith_radiance = Spectrum::Constant(1, 3);
  sky.ground_radiance = Spectrum::Constant(1, 3);
  scene.sky = sky;
  if (!thick) return scene;
  scene = with_pierced_wall(std::move(scene), -0.2, width, 2.2);
  const std::vector<Quad> lining = box_faces(Point(-width / 2, -0.2, -width / 2), Point(width / 2, 0, width / 2), true);
  for (std::size_t k = 0; k < lining.size(); ++k) {
    if (k != 2 && k != 4) scene = with_quad(std::move(scene), lining[k]);
  }
  return scene;
}

double area_of(const std::vector<Opening>& openings) {
  double area = 0;
  for (const Opening& opening : openings) area += opening.area;
  return area;
}

// From a point 2 m before the middle of a square that faces it: the configuration factor 4 / (2 pi) times the sum over
// its quarter of a / sqrt(a^2 + c^2) atan(a / sqrt(a^2 + c^2)), twice.
double factor_of_square(double width, double distance) {
  const double root = std::hypot(width / 2, distance);
  return 4 / pi * (width / 2) / root * std::atan(width / 2 / root);
}

TEST(SkyOpenings, AreTheHolesThroughWhichTheSkyShines) {
  // In millimeters and rotated, too.
  const Eigen::Affine3d turned =
      Eigen::Translation3d(3, -7, 2) * Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()) * Eigen::Scaling(0.001);
  for (const Eigen::Affine3d& motion : {Eigen::Affine3d::Identity(), turned}) {
    const double scale = std::cbrt(motion.linear().determinant());
    for (const double width : {0.02, 0.1, 1.0}) {
      const Scene scene = moved(pierced_room(width, false), motion);
      const Lighting lighting = lighting_of(scene, Tracing(scene));
      EXPECT_NEAR(area_of(lighting.openings), std::pow(scale * width, 2), 1e-6 * std::pow(scale, 2));
    }
  }
}

// Between two boards behind the hole lies another hole. All light through it has passed the first.
TEST(SkyOpenings, AreNotGapsBehindAnother) {
  Scene scene = pierced_room(1, false);
  const auto board = [](double z0, double z1) {
    return Quad{Point(-1, 1, z0), Point(-1, 1, z1), Point(1, 1, z1), Point(1, 1, z0)};
  };
  scene = with_quad(with_quad(std::move(scene), board(-1, -0.1)), board(0.1, 1));
  const std::vector<Opening> openings = lighting_of(scene, Tracing(scene)).openings;
  ASSERT_EQ(openings.size(), 1U);
  EXPECT_NEAR(openings[0].centre.y(), 0, 1e-9);
}

// Clear faces in the order of their polygons, then holes.
TEST(SkyOpenings, AreFacesFirst) {
  Scene scene = pierced_room(1, false);
  scene.materials.push_back(grey(0));
  scene.materials[1].transmittance = Spectrum::Constant(1, 0.8);
  const double y = 4;
  for (const double x : {-1.0, 0.5})
    scene = with_quad(std::move(scene),
                      {Point(x, y, -0.5), Point(x, y, 0.5), Point(x + 0.5, y, 0.5), Point(x + 0.5, y, -0.5)}, 1);
  const auto last = static_cast<PolygonIndex>(scene.polygons.size() - 1);
  const std::vector<Opening> openings = lighting_of(scene, Tracing(scene)).openings;
  ASSERT_EQ(openings.size(), 3U);
  EXPECT_EQ(first_hole(openings), 2U);
  EXPECT_EQ(opening_of(openings, last - 1), 0U);
  EXPECT_EQ(opening_of(openings, last), 1U);
  EXPECT_EQ(opening_of(openings, 0), std::nullopt);
}

TEST(SkyOpenings, AreNotWhatLiesBesideAFloorInTheOpen) {
  // Points that see much of the sky need no aimed rays. No light enters the corner of the L and the space between the
  // legs.
  Scene scene = pierced_room(1, false);
  scene.polygons.clear();
  const auto floor = [](double x0, double x1, double y0, double y1) {
    return Quad{Point(x0, y0, 0), Point(x1, y0, 0), Point(x1, y1, 0), Point(x0, y1, 0)};
  };
  scene = with_quad(with_quad(std::move(scene), floor(0, 4, 0, 1)), floor(0, 1, 1, 4));
  scene = with_quad(std::move(scene), {Point(-9, -9, -5), Point(9, -9, -5), Point(9, 9, -5), Point(-9, 9, -5)});
  EXPECT_TRUE(lighting_of(scene, Tracing(scene)).openings.empty());
}

TEST(SkyOpenings, OfTwoCentimetresLightAPointAsTheirFormFactor) {
  // E = pi L F. The hole of 2 cm is 2 m away. One of 31,000 rays over the hemisphere gets out. 2,048 rays of the point
  // go to the hole, over which the integrand varies by a thousandth.
  const Eigen::Affine3d turned =
      Eigen::Translation3d(3, -7, 2) * Eigen::Affine3d(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  for (const Eigen::Affine3d& motion : {Eigen::Affine3d::Identity(), turned}) {
    for (const double width : {0.02, 0.1}) {
      const Scene scene = moved(pierced_room(width, false), motion);
      const SurfacePoint point{motion * Point(0, 2, 0), motion.linear() * -Vector::UnitY()};
      const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), {&point, 1});
      const double expected = 3 * pi * factor_of_square(width, 2);
      EXPECT_NEAR(direct.irradiance(0, 0), expected, 0.002 * expected);
      EXPECT_LT(direct.standard_error(0, 0), 0.002 * expected);
    }
  }
}

TEST(SkyOpenings, LightAPointThatSeesLittleOfThem) {
  // A screen 0.5 m before the hole of 1 m leaves a visible strip of 1 cm, E = pi L F. About 20 of 2,048 rays to the
  // hole get out. With 32 evenly spread rays, one gets out at a third of the points.
  Scene scene = pierced_room(1, false);
  const double edge = 0.49;
  scene = with_quad(std::move(scene),
                    {Point(-2, 0.5, -2), Point(-2, 0.5, 2), Point(0.75 * edge, 0.5, 2), Point(0.75 * edge, 0.5, -2)});
  const Lighting lighting = lighting_of(scene, Tracing(scene));
  const std::vector<Point> strip{Point(edge, 0, -0.5), Point(edge, 0, 0.5), Point(0.5, 0, 0.5), Point(0.5, 0, -0.5)};
  for (int k = 0; k < 20; ++k) {
    const SurfacePoint point{Point(0, 2, 0.03 * (k - 10)), -Vector::UnitY()};
    const DirectIrradiance direct = direct_irradiance(lighting, {&point, 1});
    const double expected = 3 * pi * point_to_polygon(point.point, point.normal, strip);
    EXPECT_NEAR(direct.irradiance(0, 0), expected, 4 * direct.standard_error(0, 0)) << k;
    EXPECT_LT(direct.standard_error(0, 0), 0.3 * expected) << k;
  }
}

// A room with a window of 1 m and a closet without one behind a wall. The closet's outer wall has a slit of this width,
// 1 m high, or none. The wall consists of pieces from one z to another. The sky is uniform, 3 W/(m^2 sr).
Scene room_and_closet(double slit, const std::vector<std::pair<double, double>>& walls = {{-2, 2}}) {
  Scene scene = empty_scene({grey(0.5)});
  const std::vector<Quad> faces = box_faces(Point(-2, 0, -2), Point(4, 4, 2), true);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (k != 2) scene = with_quad(std::move(scene), faces[k]);
  }
  for (const auto& [from, to] : walls)
    scene = with_quad(std::move(scene), {Point(2, 0, from), Point(2, 4, from), Point(2, 4, to), Point(2, 0, to)});
  const auto outer = [&](double x0, double x1, double z0, double z1) {
    scene = with_quad(std::move(scene), {Point(x0, 0, z0), Point(x0, 0, z1), Point(x1, 0, z1), Point(x1, 0, z0)});
  };
  outer(-2, -1.5, -2, 2);
  outer(-0.5, 3, -2, 2);
  for (const auto& [from, to] : {std::pair{-2.0, -0.5}, {0.5, 2.0}}) {
    outer(-1.5, -0.5, from, to);
    outer(3, 3 + slit, from, to);
  }
  outer(3 + slit, 4, -2, 2);
  Sky sky;
  sky.zenith_radiance = Spectrum::Constant(1, 3);
  sky.ground_radiance = Spectrum::Constant(1, 3);
  scene.sky = sky;
  return scene;
}

TEST(SkyOpenings, LightAPointBesideAWindowThatItDoesNotSee) {
  // Rays by solid angle go to the window, and one of a few hundred to the slit. Half of the others, an eighth of 2,048,
  // go to the slit. E = pi L F. The contributions of these 128 rays differ by less than a half, and the rays are
  // stratified.
  const Scene scene = room_and_closet(0.001);
  const Lighting lighting = lighting_of(scene, Tracing(scene));
  const std::vector<Point> slit{Point(3, 0, -0.5), Point(3, 0, 0.5), Point(3.001, 0, 0.5), Point(3.001, 0, -0.5)};
  for (int k = 0; k < 20; ++k) {
    const SurfacePoint point{Point(2.4 + 0.05 * k, 3.5, 0.04 * (k - 10)), -Vector::UnitY()};
    const DirectIrradiance direct = direct_irradiance(lighting, {&point, 1});
    const double expected = 3 * pi * point_to_polygon(point.point, point.normal, slit);
    EXPECT_NEAR(direct.irradiance(0, 0), expected, 0.1 * expected) << k;
    EXPECT_NEAR(direct.irradiance(0, 0), expected, 4 * direct.standard_error(0, 0)) << k;
  }
}

TEST(SkyOpenings, ThatArriveNowhereLeaveAnErrorUnlessOneWallHidesThem) {
  // Without the slit no light arrives. Where the wall is two faces, neither of which hides the window alone, each of
  // the 2,048 or 1,792 rays to the window would contribute its part of pi L F: this much may be visible. The estimate
  // uses the area of a ball around the window, d^2 + A instead of d^2, 0.966, and the light of its middle for all of
  // it.
  const std::vector<Point> window{Point(-1.5, 0, -0.5), Point(-1.5, 0, 0.5), Point(-0.5, 0, 0.5), Point(-0.5, 0, -0.5)};
  const SurfacePoint point{Point(3, 3.5, 0), -Vector::UnitY()};
  const auto direct_light = [&](const std::vector<std::pair<double, double>>& walls) {
    const Scene scene = room_and_closet(0, walls);
    return direct_irradiance(lighting_of(scene, Tracing(scene)), {&point, 1}, {.sky_samples = 256});
  };
  const DirectIrradiance beside_two = direct_light({{-2, 0}, {0, 2}});
  const double hidden = 3 * pi * point_to_polygon(point.point, point.normal, window);
  EXPECT_EQ(beside_two.irradiance(0, 0), 0);
  EXPECT_GT(beside_two.standard_error(0, 0), 0.95 * hidden / 2048);
  EXPECT_LT(beside_two.standard_error(0, 0), hidden / 1792);

  const DirectIrradiance beside_one = direct_light({{-2, 2}});
  EXPECT_EQ(beside_one.irradiance(0, 0), 0);
  EXPECT_EQ(beside_one.standard_error(0, 0), 0);
}

TEST(SkyOpenings, InAThickWallLightAPointAsTheMouthThatItSees) {
  // From 2 m before its middle, the outer mouth at 2.2 m is the only visible part of the sky.
  const Scene scene = pierced_room(0.1, true);
  const SurfacePoint point{Point(0, 2, 0), -Vector::UnitY()};
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), {&point, 1});
  const double expected = 3 * pi * factor_of_square(0.1, 2.2);
  // A binomial of 2,048 rays to the inner mouth, 17 % of which meet the lining: a relative error of 0.01, stratified or
  // not.
  EXPECT_NEAR(direct.irradiance(0, 0), expected, 3 * 0.01 * expected);
  EXPECT_NEAR(direct.irradiance(0, 0), expected, 4 * direct.standard_error(0, 0));
  EXPECT_LT(direct.standard_error(0, 0), 0.01 * expected);
}

TEST(SkyOpenings, GiveNothingToTheWallTheyAreIn) {
  // The outside of the wall sees half of the sky, for any openings in its plane: E = pi L to the wall. It is rotated so
  // that rounding moves the opening before the wall. 1,024 samples of a constant find it to rounding.
  const Eigen::Affine3d turned =
      Eigen::Translation3d(3, -7, 2) * Eigen::Affine3d(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  for (const bool glazed : {false, true}) {
    Scene scene = pierced_room(0.1, false);
    Material glass = grey(0);
    glass.transmittance = Spectrum::Constant(1, 1);
    scene.materials.push_back(glass);
    if (glazed)
      scene = with_quad(std::move(scene),
                        {Point(-.05, 0, -.05), Point(-.05, 0, .05), Point(.05, 0, .05), Point(.05, 0, -.05)}, 1);
    scene = moved(std::move(scene), turned);
    for (int k = 1; k <= 20; ++k) {
      const SurfacePoint outside{turned * Point(1 + 0.04 * k, 0, 0.07 * k), turned.linear() * -Vector::UnitY(), 6};
      const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), {&outside, 1});
      EXPECT_NEAR(direct.irradiance(0, 0), 3 * pi, 1e-9);
      const SurfacePoint inside{outside.point, -outside.normal, 6};
      const DirectIrradiance within = direct_irradiance(lighting_of(scene, Tracing(scene)), {&inside, 1});
      EXPECT_EQ(within.irradiance(0, 0), 0);
    }
  }
}

}  // namespace
}  // namespace patchlight::sky_openings_test
