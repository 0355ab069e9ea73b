#include "lighting/mirror_chains.h"

#include "lighting/direct_irradiance.h"
#include "lighting/mirror_paths.h"
#include "support/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <span>
#include <utility>
#include <vector>

namespace patchlight::mirror_chains_test {
namespace {

using namespace test;

Material mirror(double specular_reflectance) {
  Material material = grey(0);
  material.specular_reflectance = Spectrum::Constant(1, specular_reflectance);
  return material;
}

Scene with_square(Scene scene, const Point& corner, double edge, MaterialIndex material) {
  const Vector x = edge * Vector::UnitX(), y = edge * Vector::UnitY();
  return with_quad(std::move(scene), {corner, Point(corner + x), Point(corner + x + y), Point(corner + y)}, material);
}

Luminaire point_light(const Point& position) {
  Luminaire lamp;
  lamp.position = position;
  lamp.light = PointLight{Spectrum::Constant(1, 1.0)};
  return lamp;
}

MirrorChains chains_in(const Scene& scene) {
  const Tracing tracing(scene, {}, Occluder::Blockers::all, Reflections::followed);
  return lighting_of(scene, tracing).mirrors->paths.found();
}

// A mirror of 10 x 10 m on the ground, and one of 2 cm that faces up, 10 cm below a luminaire at 2 m.
Scene large_mirror_and_reflector() {
  Scene scene = empty_scene({mirror(0.9), grey(0.5)});
  scene = with_square(std::move(scene), Point(-5, -5, 0), 10, 0);
  scene = with_square(std::move(scene), Point(-0.01, -0.01, 1.9), 0.02, 0);
  scene = with_square(std::move(scene), Point(-5, -5, 4), 10, 1);
  scene.luminaires = {point_light(Point(0, 0, 2))};
  return scene;
}

TEST(MirrorChains, OfMirrorsOfAnySizeThatALampShinesAtAreFollowed) {
  const Scene scene = large_mirror_and_reflector();
  const MirrorChains found = chains_in(scene);
  ASSERT_GE(found.chains.size(), 2U);
  EXPECT_EQ(found.chains[0].mirrors[0].polygon, 0U);
  const bool follows = std::any_of(found.chains.begin(), found.chains.end(), [](const MirrorChain& chain) {
    return chain.mirrors.size() == 1 && chain.mirrors[0].polygon == 1 && chain.mirrors[0].side == Side::front;
  });
  EXPECT_TRUE(follows);
  // The back faces away from the lamp: light reaches it only via the ground.
  for (const MirrorChain& chain : found.chains)
    EXPECT_TRUE(chain.mirrors.back().polygon == 0 || chain.mirrors.back().side == Side::front);
  EXPECT_LT(found.unfollowed_share, 1e-5);
  EXPECT_FALSE(found.is_cut);
}

TEST(MirrorChains, NeedASource) {
  Scene scene = large_mirror_and_reflector();
  scene.luminaires.clear();
  EXPECT_TRUE(chains_in(scene).chains.empty());
  EXPECT_EQ(chains_in(scene).unfollowed_share, 0);
}

// A beam of half angle 2 degrees meets one of two equal mirrors. That mirror's chain comes first at any position of the
// other.
TEST(MirrorChains, AreRankedByTheBeamsOfNarrowLamps) {
  Scene scene = empty_scene({mirror(0.5), mirror(0.9)});
  scene = with_square(std::move(scene), Point(-4, -1, 0), 2, 0);
  scene = with_square(std::move(scene), Point(-1, -1, 0), 2, 1);
  scene = with_square(std::move(scene), Point(-5, -5, 6), 0.1, 0);
  Luminaire lamp = point_light(Point(0, 0, 3));
  lamp.aim = (Point(-3, 0, 0) - lamp.position).normalized();
  lamp.light = SpotLight{Spectrum::Constant(1, 1.0), 2, 4};
  scene.luminaires = {lamp};
  const MirrorChains found = chains_in(scene);
  ASSERT_FALSE(found.chains.empty());
  EXPECT_EQ(found.chains[0].mirrors[0].polygon, 0U);
}

// Two mirrors that face each other, cut into facets. A point between them sees the same images as in whole mirrors.
struct Facets {
  static constexpr double gap = 2, reflectance = 0.9;
  Scene scene;
  SurfacePoint at{Point(1, 0, -0.5), Vector::UnitZ(), no_polygon};

  explicit Facets(std::span<const Point> lamps);
  double exact() const;
};

Facets::Facets(std::span<const Point> lamps) : scene(empty_scene({mirror(reflectance), grey(0.5)})) {
  constexpr double edge = 2;
  constexpr int half = 12;
  for (int k = -half; k < half; ++k) {
    for (int m = -half; m < half; ++m) {
      const double y = k * edge, z = m * edge;
      const Quad facet{Point(0, y, z), Point(0, y + edge, z), Point(0, y + edge, z + edge), Point(0, y, z + edge)};
      scene = with_quad(std::move(scene), facet);
      Quad other{facet[3], facet[2], facet[1], facet[0]};
      for (Point& corner : other) corner.x() = gap;
      scene = with_quad(std::move(scene), other);
    }
  }
  scene = with_square(std::move(scene), Point(0.9, -0.1, -0.5), 0.2, 1);
  for (const Point& lamp : lamps) scene.luminaires.push_back(point_light(lamp));
}

// Images at x0 + 2 k gap and -x0 + 2 k gap, by |2 k| and |2 k - 1| mirrors, within reach of the facets.
double Facets::exact() const {
  double sum = 0;
  for (const Luminaire& lamp : scene.luminaires) {
    const Point& source = lamp.position;
    const auto from = [&](double x, int mirrors) {
      if (mirrors == 0) return 0.0;
      const Vector way = Point(x, source.y(), source.z()) - at.point;
      return std::pow(reflectance, mirrors) * way.z() / std::pow(way.norm(), 3);
    };
    for (int k = -6; k <= 6; ++k)
      sum += from(source.x() + 2 * k * gap, std::abs(2 * k)) + from(-source.x() + 2 * k * gap, std::abs(2 * k - 1));
  }
  return sum;
}

// The error covers the light that is missing, and is no larger than all light.
void expect_error_of_missing_light(const Facets& facets, const Lighting& lighting) {
  EXPECT_TRUE(lighting.mirrors->paths.found().is_cut);
  const DirectIrradiance found = direct_irradiance(lighting, std::span(&facets.at, 1), {.only_in_mirrors = true});
  const double exact = facets.exact();
  const double missing = exact - found.irradiance(0, 0);
  EXPECT_GE(missing, -1e-9 * exact);
  EXPECT_LE(missing, 2 * found.standard_error(0, 0));
  EXPECT_LE(found.standard_error(0, 0), exact);
}

// The number of chains exceeds the limit.
TEST(MirrorChains, OfFacetsThatAreTooManyAreInTheError) {
  const Facets facets(std::array{Point(0.7, 0.3, 1.1)});
  const Tracing tracing(facets.scene, {}, Occluder::Blockers::all, Reflections::followed);
  const Lighting lighting = lighting_of(facets.scene, tracing);
  EXPECT_EQ(lighting.mirrors->paths.chains().size(), 1024U);
  expect_error_of_missing_light(facets, lighting);
}

// Light of luminaires that is not followed is no error of the light of faces.
TEST(MirrorChains, LeaveOutLightByKindOfSource) {
  const Facets facets(std::array{Point(0.7, 0.3, 1.1)});
  const Tracing tracing(facets.scene, {}, Occluder::Blockers::all, Reflections::followed);
  const Lighting lighting = lighting_of(facets.scene, tracing);
  const auto last = static_cast<PolygonIndex>(facets.scene.polygons.size() - 1);
  Lighting of_faces = lighting;
  of_faces.luminaires.clear();
  const LightSampler faces(of_faces, emitter_faces(facets.scene, last, Side::front));
  const MirrorPaths& paths = lighting.mirrors->paths;
  EXPECT_TRUE((paths.unfollowed_irradiance(lighting, facets.at.point, facets.at.normal) > 0).all());
  EXPECT_TRUE((paths.unfollowed_irradiance(faces, facets.at.point, facets.at.normal) == 0).all());
}

// Facets of one plane have no reflections among each other: all light of a hundred lamps is followed.
TEST(MirrorChains, AllSingleReflectionsOfManyLampsInManyMirrorsAreFollowed) {
  constexpr int edge = 10;
  Scene scene = empty_scene({mirror(0.9), grey(0.5)});
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      scene =
          with_quad(std::move(scene), {Point(x, y, 0), Point(x + 1, y, 0), Point(x + 1, y + 1, 0), Point(x, y + 1, 0)});
  scene = with_square(std::move(scene), Point(5, 5, 3), 1, 1);
  for (int k = 0; k < edge * edge; ++k)
    scene.luminaires.push_back(point_light(Point(k % edge + 0.5, k / edge + 0.5, 2)));
  const MirrorChains found = chains_in(scene);
  EXPECT_FALSE(found.is_cut);
  EXPECT_EQ(found.unfollowed_share, 0);
  std::size_t pairs = 0;
  for (const MirrorChain& chain : found.chains) pairs += chain.sources.size();
  EXPECT_EQ(pairs, edge * edge * scene.luminaires.size());
}

// The beams of 64 lamps to the facets are too many to be tested.
TEST(MirrorChains, OfBeamsThatAreTooManyAreInTheError) {
  std::vector<Point> lamps;
  for (int k = 0; k < 64; ++k) lamps.emplace_back(0.2 + 0.025 * k, -0.8 + 0.2 * (k % 8), 1.1);
  const Facets facets(lamps);
  const Tracing tracing(facets.scene, {}, Occluder::Blockers::all, Reflections::followed);
  expect_error_of_missing_light(facets, lighting_of(facets.scene, tracing));
}

}  // namespace
}  // namespace patchlight::mirror_chains_test
