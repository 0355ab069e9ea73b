#include "render/light_samples.h"

#include "patchlight/scene/sides.h"

#include "form_factor/point_polygon.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace patchlight::light_samples_test {
namespace {

using namespace test;

constexpr double exitance = 10;

// A floor under a vertical lamp in front of a point of it, half of it below the floor's plane: x = 0.2.
Scene floor_and_lamp() {
  Scene scene = with_quad(empty_scene({grey(0.5), grey(0, exitance)}),
                          {Point(-2, -2, 0), Point(2, -2, 0), Point(2, 2, 0), Point(-2, 2, 0)});
  return with_quad(std::move(scene), {Point(0.2, -1, -1), Point(0.2, -1, 1), Point(0.2, 1, 1), Point(0.2, 1, -1)}, 1);
}

// The mean of many samples at the origin, facing up, and its standard error by independent sequences.
struct Mean {
  double irradiance = 0;
  double standard_error = 0;
  double largest_deviation = 0;  // of one sample
};

Mean mean_at_origin(const Scene& scene, std::uint32_t rays) {
  constexpr std::uint32_t sequences = 128;
  constexpr std::uint32_t samples = 256;
  const Tracing tracing(scene, find_coverings(scene, kept_sides(scene, Sides::both)), Occluder::Blockers::all,
                        Reflections::kept);
  const Lighting lighting = lighting_of(scene, tracing);
  const LightSampler lights(lighting, emitter_faces(scene, 1, Side::front));
  Mean mean;
  double squares = 0;
  std::vector<double> all;
  for (std::uint32_t seed = 1; seed <= sequences; ++seed) {
    std::vector<LitPoint> points;
    for (std::uint32_t k = 0; k < samples; ++k) points.push_back({{Point::Zero(), Vector::UnitZ(), 0}, k, seed});
    const Field found = light_samples(lights, points, rays);
    mean.irradiance += found.mean() / sequences;
    squares += found.mean() * found.mean() / sequences;
    for (Eigen::Index k = 0; k < found.rows(); ++k) all.push_back(found(k, 0));
  }
  for (const double one : all)
    mean.largest_deviation = std::max(mean.largest_deviation, std::abs(one - mean.irradiance));
  mean.standard_error = std::sqrt(std::max(0.0, squares - mean.irradiance * mean.irradiance) / (sequences - 1));
  return mean;
}

// The plane of the floor cuts a lamp. Each sample includes the whole part above it, though the floor stops rays to the
// rest.
TEST(LightSamples, OfALampThatTheHorizonCutsAreExact) {
  const Scene scene =
      with_quad(floor_and_lamp(), {Point(-2, -2, -0.01), Point(2, -2, -0.01), Point(2, 2, -0.01), Point(-2, 2, -0.01)});
  const std::vector<Point> above{Point(0.2, -1, 0), Point(0.2, -1, 1), Point(0.2, 1, 1), Point(0.2, 1, 0)};
  const double exact = exitance * point_to_polygon(Point::Zero(), Vector::UnitZ(), above);
  for (const std::uint32_t rays : {2U, 4U, 5U, 16U}) {
    const Mean mean = mean_at_origin(scene, rays);
    EXPECT_NEAR(mean.irradiance, exact, 1e-9 * exact) << rays;
    EXPECT_LT(mean.largest_deviation, 1e-9 * exact) << rays;
  }
}

// A wall halfway hides the right part. Evenly spread rays estimate its fraction without bias.
TEST(LightSamples, OfALampThatIsHiddenInPartHaveItsMean) {
  Scene scene =
      with_quad(floor_and_lamp(), {Point(0.1, 0.05, -1), Point(0.1, 0.05, 2), Point(0.1, 2, 2), Point(0.1, 2, -1)});
  const std::vector<Point> seen{Point(0.2, -1, 0), Point(0.2, -1, 1), Point(0.2, 0.1, 1), Point(0.2, 0.1, 0)};
  const double exact = exitance * point_to_polygon(Point::Zero(), Vector::UnitZ(), seen);
  for (const std::uint32_t rays : {2U, 4U, 5U, 16U}) {
    const Mean mean = mean_at_origin(scene, rays);
    EXPECT_NEAR(mean.irradiance, exact, 4 * mean.standard_error) << rays;
    EXPECT_LT(mean.standard_error, 0.01 * exact) << rays;
  }
}

}  // namespace
}  // namespace patchlight::light_samples_test
