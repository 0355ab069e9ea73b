#include "patchlight/scene/sides.h"

#include "lighting/direct_irradiance.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <span>
#include <vector>

namespace patchlight::irradiance_in_mirrors_test {
namespace {

using namespace test;

// A floor of one patch, 3 x 1 m, with a rug on a third of it. A mirror reflects the sun onto all of it.
Scene floor_before_mirror() {
  Material mirror = grey(0);
  mirror.specular_reflectance = Spectrum::Constant(1, 0.9);
  Scene scene =
      with_quad(empty_scene({grey(0.5), mirror}), {Point(0, 0, 0), Point(3, 0, 0), Point(3, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(4, -9, -9), Point(4, -9, 9), Point(4, 9, 9), Point(4, 9, -9)}, 1);
  scene.sun = Sun{Vector(-1, 0, 1).normalized(), Spectrum::Constant(1, 10)};
  return scene;
}

TEST(IrradianceInMirrors, OfThePartOverWhichNothingLiesIsThatOfEveryPlaceThere) {
  const Scene scene = floor_before_mirror();
  const KeptSides sides = kept_sides(scene, Sides::front);
  const PatchMesh mesh = tessellate(scene, sides, 20);
  const Tracing tracing(scene, find_coverings(scene, sides), Occluder::Blockers::all, Reflections::followed);
  const Lighting lighting = lighting_of(scene, tracing);
  ASSERT_TRUE(lighting.mirrors);
  const double everywhere = 0.9 * 10 * std::sqrt(0.5);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    for (const int samples : {2, 4, 16, 64}) {
      const DirectIrradiance direct =
          direct_irradiance(lighting, mesh, {.mirrored_samples = samples, .seed = seed, .only_in_mirrors = true});
      const double irradiance = direct.irradiance(0, 0);
      // Two samples, in replicates of one, may both lie on the rug.
      if (samples == 2 && irradiance == 0) continue;
      EXPECT_NEAR(irradiance, everywhere, 1e-12 * everywhere) << samples << " samples, seed " << seed;
      found += samples == 2;
    }
  }
  EXPECT_GT(found, 15);
}

// Mirrors that face each other have an infinite row of images of a lamp. Chains of up to sixteen mirrors are followed,
// and the error covers the rest. The sum is over images k = 1, 2 ... of a small ball, on either side, at distance z
// from mirror 0.
TEST(IrradianceInMirrors, HasTheErrorOfImagesThatAreTooManyToBeFollowed) {
  constexpr double gap = 2, height = 1, radius = 0.05;
  for (const double reflectance : {0.8, 0.97, 1.0}) {
    Material mirror = grey(0);
    mirror.specular_reflectance = Spectrum::Constant(1, reflectance);
    Scene scene = empty_scene({grey(0.5), mirror});
    constexpr double far = 500;
    scene = with_quad(std::move(scene), {Point(0.9, -1, 0), Point(1.1, -1, 0), Point(1.1, 1, 0), Point(0.9, 1, 0)});
    scene = with_quad(std::move(scene),
                      {Point(0, -far, -far), Point(0, far, -far), Point(0, far, far), Point(0, -far, far)}, 1);
    scene = with_quad(std::move(scene),
                      {Point(gap, -far, -far), Point(gap, -far, far), Point(gap, far, far), Point(gap, far, -far)}, 1);
    Luminaire lamp;
    lamp.position = Point(1, 0, height);
    lamp.light = SphericalLamp{radius, Spectrum::Constant(1, 7)};
    scene.luminaires = {lamp};
    const Tracing tracing(scene, {}, Occluder::Blockers::all, Reflections::followed);
    const Lighting lighting = lighting_of(scene, tracing);
    ASSERT_TRUE(lighting.mirrors);
    const std::vector<SurfacePoint> points{{Point(1, 0, 0), Vector::UnitZ(), 0}};
    const DirectIrradiance found = direct_irradiance(lighting, points, {.only_in_mirrors = true});
    // E sin^2 of the half angle times the cosine of each image, at a distance of k gaps to the side.
    double exact = 0;
    for (double k = 1; k < 100000; ++k) {
      const double squared = height * height + k * k * gap * gap;
      exact += 2 * std::pow(reflectance, k) * 7 * radius * radius / squared * height / std::sqrt(squared);
    }
    const double missing = exact - found.irradiance(0, 0);
    EXPECT_GE(missing, -3 * found.standard_error(0, 0));
    EXPECT_LE(missing, found.standard_error(0, 0)) << reflectance;
    EXPECT_LE(found.standard_error(0, 0), 0.01 * exact) << reflectance;
  }
}

// A spot, a sequence of mirrors of any size that it may be aimed at, and a point lit by the last mirror.
struct AimedSpot {
  Scene scene;
  SurfacePoint at;
  double expected = 0;  // by the image of the spot: I cos / d^2 along the unfolded path, times the reflectances
};

// A square around a point that reflects light from one point to another.
Quad square_mirror(const Point& middle, const Point& from, const Point& to, double edge) {
  const Vector normal = ((from - middle).normalized() + (to - middle).normalized()).normalized();
  const Vector u = edge / 2 * normal.unitOrthogonal();
  const Vector v = normal.cross(u);
  return {Point(middle - u - v), Point(middle + u - v), Point(middle + u + v), Point(middle - u + v)};
}

AimedSpot aimed_spot(std::mt19937& random, std::size_t mirrors) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  Material material = grey(0);
  material.specular_reflectance = Spectrum::Constant(1, 0.9);
  AimedSpot spot{empty_scene({grey(0.5), material}), {}, 50};
  // Above a mirror of 12 m on the floor, diagonally across a room.
  spot.scene =
      with_quad(std::move(spot.scene), {Point(-3, -3, 0), Point(9, -3, 0), Point(9, 9, 0), Point(-3, 9, 0)}, 1);
  spot.scene =
      with_quad(std::move(spot.scene), {Point(-3, -3, 5), Point(-3, 9, 5), Point(9, 9, 5), Point(9, -3, 5)}, 0);
  std::vector<Point> places;
  for (std::size_t k = 0; k < mirrors + 2; ++k)
    places.push_back(Point(k % 2 == 0 ? between(0, 1) : between(5, 6), between(0, 6), between(1.5, 3)));
  double length = 0;
  for (std::size_t k = 1; k < places.size(); ++k) length += (places[k] - places[k - 1]).norm();
  for (std::size_t k = 1; k <= mirrors; ++k) {
    const Quad square = square_mirror(places[k], places[k - 1], places[k + 1], between(0.01, 0.1));
    spot.scene = with_quad(std::move(spot.scene), square, 1);
    spot.expected *= 0.9;
  }
  Luminaire lamp;
  lamp.position = places[0];
  lamp.aim = (places[1] - places[0]).normalized();
  const double beam = between(1, 4);
  const SpotLight light{Spectrum::Constant(1, 50), beam, between(1.5, 2.2) * beam};
  lamp.light = light;
  spot.scene.luminaires = {lamp};
  const Vector arriving = (places[mirrors] - places.back()).normalized();
  const Vector normal = (arriving + 0.5 * Vector::UnitY()).normalized();
  spot.at = {places.back(), normal, no_polygon};
  spot.expected *= normal.dot(arriving) / (length * length);
  // The floor shows the tail of the beam.
  const Point image(places.back().x(), places.back().y(), -places.back().z());
  const Vector way = image - places[0];
  const Vector normal_there(normal.x(), normal.y(), -normal.z());
  spot.expected += 0.9 * 50 * spot_profile(light, lamp.aim.dot(way.normalized())) *
                   std::max(0.0, -normal_there.dot(way)) / std::pow(way.norm(), 3);
  return spot;
}

// Rotated, and in the size of a millimeter model that is read in meters: irradiance decreases with the square of
// lengths.
TEST(IrradianceInMirrors, OfNarrowSpotsAtSmallMirrorsIsThatOfTheirImages) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 40; ++trial) {
    const AimedSpot spot = aimed_spot(random, trial % 3 == 2 ? 2 : 1);
    for (const double scale : {1.0, 1000.0}) {
      Eigen::Affine3d motion = Eigen::Affine3d::Identity();
      if (scale != 1)
        motion = Eigen::Scaling(scale) * Eigen::AngleAxisd(0.7, Vector(1, 2, -1).normalized()) *
                 Eigen::Translation3d(0.3, -5, 2);
      const Eigen::Matrix3d rotation = motion.linear() / scale;
      Scene scene = moved(spot.scene, motion);
      Luminaire& lamp = scene.luminaires[0];
      lamp.position = motion * spot.scene.luminaires[0].position;
      lamp.aim = rotation * spot.scene.luminaires[0].aim;
      const SurfacePoint at{motion * spot.at.point, rotation * spot.at.normal, no_polygon};
      const Tracing tracing(scene, {}, Occluder::Blockers::all, Reflections::followed);
      const Lighting lighting = lighting_of(scene, tracing);
      const DirectIrradiance found = direct_irradiance(lighting, std::span(&at, 1), {.only_in_mirrors = true});
      const double expected = spot.expected / (scale * scale);
      // The profile of a spot amplifies the rounding of the cosine, 1e-16: 2^-(1e-8 / 0.02)^1.5 is 1 - 2e-10. Tails of
      // beams via two mirrors are smaller than 1e-6.
      EXPECT_NEAR(found.irradiance(0, 0), expected, 1e-6 * expected + 3 * found.standard_error(0, 0))
          << "trial " << trial << ", scale " << scale;
      EXPECT_LT(found.standard_error(0, 0), 0.01 * expected);
    }
  }
}

// The sides of an upright prism are equal mirrors. Its top is open to an even sky of radiance 1.
constexpr int ring_sides = 40;  // more than are targets of rays
constexpr double ring_height = 2, ring_reflectance = 0.9;

Point ring_corner(int k, double z) {
  const double radius = 1 / std::cos(std::numbers::pi / ring_sides);  // of an inradius of 1
  const double angle = (2 * k + 1) * std::numbers::pi / ring_sides;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

Scene ring_of_mirrors() {
  Material mirror = grey(0);
  mirror.specular_reflectance = Spectrum::Constant(1, ring_reflectance);
  Scene scene = empty_scene({mirror});
  for (int k = 0; k < ring_sides; ++k)
    scene = with_quad(std::move(scene), {ring_corner(k, 0), ring_corner(k, ring_height),
                                         ring_corner(k + 1, ring_height), ring_corner(k + 1, 0)});
  Sky sky;
  sky.kind = SkyKind::uniform;
  sky.zenith_radiance = Spectrum::Ones(1);
  sky.ground_radiance = Spectrum::Zero(1);
  scene.sky = sky;
  return scene;
}

// The number of reflections of a path in the plane, of a length, before it ends.
int reflections_in_ring(Eigen::Vector2d place, Eigen::Vector2d direction, double length) {
  int reflections = 0;
  for (; reflections < 400; ++reflections) {
    double nearest = length;
    Eigen::Vector2d normal(0, 0);
    for (int k = 0; k < ring_sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / ring_sides;
      const Eigen::Vector2d outward(std::cos(angle), std::sin(angle));
      const double toward = outward.dot(direction);
      const double distance = (1 - outward.dot(place)) / toward;
      if (toward > 1e-12 && distance < nearest) {
        nearest = distance;
        normal = outward;
      }
    }
    if (nearest == length) break;
    place += nearest * direction;
    direction -= 2 * normal.dot(direction) * normal;
    length -= nearest;
  }
  return reflections;
}

// E = integral of rho^k cos over the directions with k > 0 reflections, by 200 x 200 directions distributed as the
// cosine. Doubling their number changes the sum by less than 1e-3.
TEST(IrradianceInMirrors, OfMoreEqualMirrorsThanTargetsHasTheSkyOfAll) {
  const SurfacePoint at{Point(0.3, 0.1, 0.2), Vector::UnitZ(), no_polygon};
  constexpr int steps = 200;
  double exact = 0;
  for (int ring = 0; ring < steps; ++ring) {
    const double sine = std::sqrt((ring + 0.5) / steps);
    const double length = (ring_height - at.point.z()) * sine / std::sqrt(1 - sine * sine);
    for (int sector = 0; sector < steps; ++sector) {
      const double angle = 2 * std::numbers::pi * (sector + 0.5) / steps;
      const int k = reflections_in_ring(at.point.head<2>(), {std::cos(angle), std::sin(angle)}, length);
      if (k > 0) exact += std::numbers::pi / (steps * steps) * std::pow(ring_reflectance, k);
    }
  }
  const Scene scene = ring_of_mirrors();
  const Tracing tracing(scene, {}, Occluder::Blockers::all, Reflections::followed);
  const Lighting lighting = lighting_of(scene, tracing);
  double mean = 0, variance = 0;
  constexpr int seeds = 8;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const DirectIrradiance found =
        direct_irradiance(lighting, std::span(&at, 1), {.seed = seed, .only_in_mirrors = true});
    mean += found.irradiance(0, 0) / seeds;
    variance += std::pow(found.standard_error(0, 0) / seeds, 2);
  }
  EXPECT_NEAR(mean, exact, 4 * std::sqrt(variance) + 1e-3 * exact);
  EXPECT_LT(std::sqrt(variance), 0.01 * exact);
}

// Chains of mirrors are searched for groups of points. A single point gets the same bits as among others, some of which
// only the other mirror lights.
TEST(IrradianceInMirrors, OfAPointDoesNotDependOnThoseAroundIt) {
  Material left = grey(0);
  left.specular_reflectance = Spectrum::Constant(1, 0.9);
  Material right = grey(0);
  right.specular_reflectance = Spectrum::Constant(1, 0.5);
  Scene scene = empty_scene({grey(0.5), left, right});
  scene = with_quad(std::move(scene), {Point(-9, -9, 0), Point(9, -9, 0), Point(9, 9, 0), Point(-9, 9, 0)});
  scene = with_quad(std::move(scene), {Point(-5, -1, 1), Point(-5, 1, 1), Point(-5, 1, 2), Point(-5, -1, 2)}, 1);
  scene = with_quad(std::move(scene), {Point(5, -1, 1), Point(5, -1, 2), Point(5, 1, 2), Point(5, 1, 1)}, 2);
  Luminaire lamp;
  lamp.position = Point(0, 0, 4);
  lamp.light = SphericalLamp{0.2, Spectrum::Constant(1, 7)};
  scene.luminaires = {lamp};
  const Tracing tracing(scene, {}, Occluder::Blockers::all, Reflections::followed);
  const Lighting lighting = lighting_of(scene, tracing);
  ASSERT_TRUE(lighting.mirrors);
  std::vector<SurfacePoint> points;
  for (int k = 0; k < 150; ++k) points.push_back({Point(-4.5 + 0.06 * k, 0.1, 0), Vector::UnitZ(), 0});
  const DirectIrradiance all = direct_irradiance(lighting, points, {.only_in_mirrors = true});
  // Points keep their numbers, which determine their samples: the earlier points are moved to one place, far away.
  int lit = 0;
  for (const std::size_t k : {0UL, 10UL, 63UL, 64UL, 75UL, 149UL}) {
    std::vector<SurfacePoint> alone(k, {Point(0, 8.9, 0), Vector::UnitZ(), 0});
    alone.push_back(points[k]);
    const DirectIrradiance one = direct_irradiance(lighting, alone, {.only_in_mirrors = true});
    const auto row = static_cast<Eigen::Index>(k);
    EXPECT_EQ(one.irradiance(row, 0), all.irradiance(row, 0)) << "point " << k;
    EXPECT_EQ(one.standard_error(row, 0), all.standard_error(row, 0)) << "point " << k;
    lit += all.irradiance(row, 0) > 0;
  }
  EXPECT_GT(lit, 1);
  EXPECT_LT(lit, 6);
}

// A floor that is lit by a ball via a mirror too small for the whole image. Three doublings leave an eighth of the
// variance, or less, because samples are stratified. Other patches keep their bits.
TEST(IrradianceInMirrors, OfDoubledPatchesHasAsManyMoreRays) {
  Material mirror = grey(0);
  mirror.specular_reflectance = Spectrum::Constant(1, 0.9);
  Scene scene =
      with_quad(empty_scene({grey(0.5), mirror}), {Point(-4, -4, 0), Point(4, -4, 0), Point(4, 4, 0), Point(-4, 4, 0)});
  scene = with_quad(std::move(scene), {Point(-5, -1, 1), Point(-5, 1, 1), Point(-5, 1, 2), Point(-5, -1, 2)}, 1);
  Luminaire lamp;
  lamp.position = Point(0, 0, 4);
  lamp.light = SphericalLamp{0.5, Spectrum::Constant(1, 7)};
  scene.luminaires = {lamp};
  const Tracing tracing(scene, {}, Occluder::Blockers::all, Reflections::followed);
  const Lighting lighting = lighting_of(scene, tracing);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 2);
  std::vector<std::uint8_t> doublings(mesh.size(), 0);
  for (PatchIndex i = 0; i < mesh.size(); i += 2) doublings[i] = 3;
  Field usual = Field::Zero(mesh.size(), 1);
  Field doubled = usual;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const LightingOptions few{.mirrored_samples = 32, .seed = seed};
    LightingOptions more = few;
    more.doublings = doublings;
    const DirectIrradiance before = direct_irradiance(lighting, mesh, few);
    const DirectIrradiance after = direct_irradiance(lighting, mesh, more);
    usual += before.standard_error.square();
    doubled += after.standard_error.square();
    for (PatchIndex i = 1; i < mesh.size(); i += 2) EXPECT_EQ(before.irradiance(i, 0), after.irradiance(i, 0));
  }
  double squares_before = 0;
  double squares_after = 0;
  for (PatchIndex i = 0; i < mesh.size(); i += 2) squares_before += usual(i, 0), squares_after += doubled(i, 0);
  ASSERT_GT(squares_before, 0);
  EXPECT_LT(squares_after, 1.25 * squares_before / 8);
}

}  // namespace
}  // namespace patchlight::irradiance_in_mirrors_test
