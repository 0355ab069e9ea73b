#include "lighting/sky_divisions.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::sky_divisions_test {
namespace {

constexpr double pi = std::numbers::pi;

TEST(SkyDivisions, TileTheHemisphere) {
  for (const int factor : {1, 2, 4}) {
    const SkyDivisions divisions(factor, Vector::UnitZ(), Vector::UnitY());
    EXPECT_EQ(divisions.size(), static_cast<std::size_t>(144 * factor * factor + 2));  // Reinhart 2001
    double sum = 0;
    for (std::size_t d = 1; d < divisions.size(); ++d) sum += divisions.solid_angle(d);
    EXPECT_NEAR(sum, 2 * pi, 1e-12);
    EXPECT_EQ(divisions.at(-Vector::UnitZ()), 0U);
    EXPECT_EQ(divisions.at(Vector::UnitZ()), divisions.size() - 1);
  }
}

TEST(SkyDivisions, EachDirectionLiesInTheDivisionThatItCameFrom) {
  // An axis that is none of the coordinates'.
  const Vector up = Vector(1, 2, 3).normalized();
  const Vector north = up.unitOrthogonal();
  for (const int factor : {1, 2, 4}) {
    const SkyDivisions divisions(factor, up, north);
    for (std::size_t d = 1; d < divisions.size(); ++d)
      for (const Vector& direction : divisions.directions(d, 5)) {
        EXPECT_NEAR(direction.norm(), 1, 1e-12);
        ASSERT_EQ(divisions.at(direction), d);
      }
  }
}

TEST(SkyDivisions, StandInTheOrderOfRadiance) {
  const SkyDivisions divisions(1, Vector::UnitZ(), Vector::UnitY());
  const auto at = [&](double altitude, double azimuth) {
    const double h = altitude * pi / 180, a = azimuth * pi / 180;
    return divisions.at({std::cos(h) * std::sin(a), std::cos(h) * std::cos(a), std::sin(h)});
  };
  EXPECT_EQ(at(6, 0), 1U);  // the north at the horizon, then to the east
  EXPECT_EQ(at(6, 12), 2U);
  EXPECT_EQ(at(6, 348), 30U);
  EXPECT_EQ(at(18, 0), 31U);
  EXPECT_EQ(at(78, 0), 139U);
  EXPECT_EQ(at(85, 200), 145U);
}

}  // namespace
}  // namespace patchlight::sky_divisions_test
