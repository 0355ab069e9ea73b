#include "lighting/light_source.h"

#include "patchlight/scene/sides.h"

#include "scene/coverings.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <utility>
#include <vector>

namespace patchlight::light_source_test {
namespace {

using namespace test;

Luminaire luminaire_at(const Point& position, decltype(Luminaire::light) light) {
  Luminaire luminaire;
  luminaire.position = position;
  luminaire.light = std::move(light);
  return luminaire;
}

// Spheres, spots, points, the sun, and a square and a long strip that emit.
struct MixedLight {
  Scene scene;
  Tracing tracing;
  Lighting lighting;
  LightSampler sampler;

  explicit MixedLight(Scene all)
      : scene(std::move(all)),
        tracing(scene, find_coverings(scene, kept_sides(scene, Sides::both)), Occluder::Blockers::all,
                Reflections::kept),
        lighting(lighting_of(scene, tracing)),
        sampler(lighting, faces()) {}

  std::vector<EmitterFace> faces() const {
    std::vector<EmitterFace> all;
    for (const PolygonIndex polygon : {1U, 2U})
      for (const EmitterFace& face : emitter_faces(scene, polygon, Side::front)) all.push_back(face);
    return all;
  }
};

Scene mixed_scene(int luminaires) {
  Scene scene = with_quad(empty_scene({grey(0.5), grey(0, 10)}),
                          {Point(-5, -5, 0), Point(5, -5, 0), Point(5, 5, 0), Point(-5, 5, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 3), Point(0, 1, 3), Point(1, 1, 3), Point(1, 0, 3)}, 1);
  scene = with_quad(std::move(scene), {Point(-5, 2, 3), Point(-5, 2.05, 3), Point(5, 2.05, 3), Point(5, 2, 3)}, 1);
  for (int k = 0; k < luminaires; ++k) {
    const Point position(k - 2, 0.5 * k - 1, 2.5);
    if (k % 3 == 0)
      scene.luminaires.push_back(luminaire_at(position, SphericalLamp{0.1, Spectrum::Constant(1, 30)}));
    else if (k % 3 == 1)
      scene.luminaires.push_back(luminaire_at(position, SpotLight{Spectrum::Constant(1, 40), 20, 60}));
    else
      scene.luminaires.push_back(luminaire_at(position, PointLight{Spectrum::Constant(1, 5)}));
  }
  scene.sun = Sun{Vector(0.3, 0.2, 1).normalized(), Spectrum::Constant(1, 3)};
  return scene;
}

SurfacePoint random_point(std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> place(-4, 4), height(0.05, 3.5);
  return {Point(place(random), place(random), height(random)),
          Vector(normal(random), normal(random), normal(random)).normalized(), no_polygon};
}

// Points below, above and beside the sources, some with the source at their horizon.
TEST(LightSource, LightThatArrivesIsPossible) {
  const MixedLight light(mixed_scene(6));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  int lit = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const SurfacePoint at = random_point(random);
    for (const LightSource& source : light.sampler.sources()) {
      if (!(source.sample(at, {uniform(random), uniform(random)}).irradiance > 0)) continue;
      ++lit;
      EXPECT_GT(source.possible_irradiance(at), 0) << "source " << source.id();
    }
  }
  EXPECT_GT(lit, 10000);
}

// Midpoints of a 400 x 400 grid; E G is smooth where the point is farther away than the strip is wide.
TEST(LightSource, TheMeanSampleOfAFaceIsItsFormFactor) {
  const MixedLight light(mixed_scene(0));
  const SurfacePoint at{Point(0.4, 1.2, 1), Vector(0.1, 0.2, 1).normalized(), no_polygon};
  for (const LightSource& source : light.sampler.sources()) {
    if (!source.unoccluded(at)) continue;
    constexpr int steps = 400;
    double mean = 0;
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j)
        mean += source.sample(at, {(i + 0.5) / steps, (j + 0.5) / steps}).irradiance / (steps * steps);
    EXPECT_NEAR(mean / *source.unoccluded(at), 1, 1e-4);
  }
}

// The choice at equal steps is exact up to the steps of u, whose number is prime to those of the choices.
TEST(LightSampler, ChosenSourcesStandForAll) {
  for (const int luminaires : {0, 3, 5, 20}) {
    const MixedLight light(mixed_scene(luminaires));
    std::mt19937 random(2);
    for (int trial = 0; trial < 20; ++trial) {
      const SurfacePoint at = random_point(random);
      // Any value per source, here its index and one.
      double all = 0;
      for (std::uint32_t k = 0; k < light.sampler.sources().size(); ++k)
        if (light.sampler.sources()[k].possible_irradiance(at) > 0) all += k + 1;
      constexpr int steps = 20011;
      double mean = 0;
      for (int step = 0; step < steps; ++step)
        for (const SourceChoice& choice : light.sampler.choose(at, 4, (step + 0.5) / steps))
          mean += choice.factor * (choice.index + 1) / steps;
      // A source of probability p is found p times steps times, rounded: off by 1 / (p steps) relative.
      EXPECT_NEAR(mean, all, 0.02 * all) << luminaires << " luminaires, trial " << trial;
    }
  }
}

// The end of a strip of 10 m x 5 cm lights the wall before it most.
TEST(LightSampler, APointBeforeTheEndOfALongStripGetsRaysToIt) {
  const MixedLight light(mixed_scene(0));
  const SurfacePoint at{Point(-4.9, 2.02, 2.9), Vector::UnitZ(), no_polygon};
  for (const LightSource& source : light.sampler.sources()) {
    if (!source.unoccluded(at) || !(*source.unoccluded(at) > 0)) continue;
    const double ratio = source.possible_irradiance(at) / (10 * *source.unoccluded(at));
    EXPECT_GT(ratio, 0.5) << "source " << source.id();
    EXPECT_LT(ratio, 2) << "source " << source.id();
  }
}

}  // namespace
}  // namespace patchlight::light_source_test
