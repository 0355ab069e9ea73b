#include "patchlight/base/error.h"

#include "render/camera.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::lens_test {
namespace {

constexpr double pi = std::numbers::pi;

Camera camera_of(Projection projection, double angle) {
  Camera camera{Point(1, 2, 3), Point(1, 5, 3), angle};
  camera.projection = projection;
  return camera;
}

TEST(Lens, LooksAtTheTargetInTheMiddle) {
  for (const Projection projection :
       {Projection::perspective, Projection::angular, Projection::hemispherical, Projection::panorama}) {
    const auto ray = Lens(camera_of(projection, 90), Vector::UnitZ(), 30, 20).ray(15, 10);
    ASSERT_TRUE(ray);
    EXPECT_LT((ray->direction - Vector::UnitY()).norm(), 1e-12) << name_of(projection);
    EXPECT_EQ(ray->origin, Point(1, 2, 3));
  }
}

TEST(Lens, HasTheFieldOfViewAtItsUpperEdge) {
  for (const Projection projection :
       {Projection::perspective, Projection::angular, Projection::hemispherical, Projection::panorama}) {
    const auto ray = Lens(camera_of(projection, 90), Vector::UnitZ(), 30, 20).ray(15, 1e-9);
    ASSERT_TRUE(ray);
    // 45 degrees up.
    EXPECT_LT((ray->direction - Vector(0, 1, 1).normalized()).norm(), 1e-8) << name_of(projection);
  }
}

TEST(Lens, OfEqualAreaHasTheProjectedSolidAngleOfThePixels) {
  // The cosine-weighted integral of 1 over the hemisphere is pi: each pixel has the weight (2 / height)^2.
  const Lens lens(camera_of(Projection::hemispherical, 180), Vector::UnitZ(), 400, 400);
  int inside = 0;
  double elevation = 0;
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 400; ++x) {
      const auto ray = lens.ray(x + 0.5, y + 0.5);
      if (!ray) continue;
      ++inside;
      elevation += std::pow(ray->direction.y(), 2);
    }
  }
  EXPECT_NEAR(inside * std::pow(2.0 / 400, 2), pi, 0.01);
  // The mean of cos^2 weighted by the cosine is 1/2.
  EXPECT_NEAR(elevation / inside, 0.5, 0.01);
}

TEST(Lens, OfAPlanHasParallelRaysFromThePlaneOfTheEye) {
  Camera plan = camera_of(Projection::orthographic, 50);
  plan.height = 4;
  const Lens lens(plan, Vector::UnitZ(), 30, 20);
  const auto corner = lens.ray(0, 0);
  ASSERT_TRUE(corner);
  EXPECT_LT((corner->direction - Vector::UnitY()).norm(), 1e-12);
  EXPECT_LT((corner->origin - Point(1 - 3, 2, 3 + 2)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(lens.pixel_width(100), 0.2);
}

TEST(Lens, SeesBehindItselfInAPanorama) {
  const Lens lens(camera_of(Projection::panorama, 180), Vector::UnitZ(), 400, 200);
  const auto left_end = lens.ray(1e-9, 100);
  ASSERT_TRUE(left_end);
  EXPECT_LT((left_end->direction + Vector::UnitY()).norm(), 1e-8);
}

TEST(Lens, RefusesWhatIsNoView) {
  EXPECT_THROW(Lens(camera_of(Projection::perspective, 180), Vector::UnitZ(), 4, 4), InputError);
  EXPECT_THROW(Lens(camera_of(Projection::angular, 361), Vector::UnitZ(), 4, 4), InputError);
  EXPECT_THROW(Lens(camera_of(Projection::orthographic, 50), Vector::UnitZ(), 4, 4), InputError);
}

}  // namespace
}  // namespace patchlight::lens_test
