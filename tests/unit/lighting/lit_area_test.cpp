#include "base/sampling.h"
#include "lighting/shades.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::lit_area_test {
namespace {

using Eigen::Vector2d;

const PlanarOutline square{Vector2d(0, 0), Vector2d(1, 0), Vector2d(1, 1), Vector2d(0, 1)};

PlanarOutline rectangle(double x0, double x1, double y0, double y1) {
  return {Vector2d(x0, y0), Vector2d(x1, y0), Vector2d(x1, y1), Vector2d(x0, y1)};
}

double lit(const std::vector<Shade>& shades) {
  const auto area = lit_area(square, shades, 1);
  return area ? (*area)[0] : -1;
}

TEST(LitArea, OfNoShadowIsAll) { EXPECT_DOUBLE_EQ(lit({}), 1); }

TEST(LitArea, OfShadowsBesideEachOtherIsNothing) {
  // Two triangles that share a diagonal, for example of a roof: no light passes between them.
  EXPECT_EQ(lit({{{Vector2d(-1, -1), Vector2d(3, -1), Vector2d(-0.3, 2)}, nullptr},
                 {{Vector2d(3, -1), Vector2d(3, 3), Vector2d(-0.3, 2)}, nullptr}}),
            0);
}

TEST(LitArea, OfOverlappingShadowsIsThatOutsideTheirUnion) {
  // 0.5 x 0.5 twice, with 0.25 x 0.25 in common.
  EXPECT_NEAR(lit({{rectangle(0, 0.5, 0, 0.5), nullptr}, {rectangle(0.25, 0.75, 0.25, 0.75), nullptr}}),
              1 - (0.5 - 0.0625), 1e-15);
}

TEST(LitArea, OfAHoleBetweenFourShadowsIsTheHole) {
  // For any size.
  for (const double edge : {0.2, 1e-3, 1e-5}) {
    const double a = 0.37;
    const double b = a + edge;
    EXPECT_NEAR(lit({{rectangle(-1, a, -1, 2), nullptr},
                     {rectangle(b, 2, -1, 2), nullptr},
                     {rectangle(a, b, -1, a), nullptr},
                     {rectangle(a, b, b, 2), nullptr}}),
                edge * edge, 1e-12 * edge);
  }
}

TEST(LitArea, OfPanesIsTheProductOfTheirTransmittances) {
  const Spectrum half = Spectrum::Constant(1, 0.5);
  const Spectrum tenth = Spectrum::Constant(1, 0.1);
  // One pane covers everything, another one a quarter. A pane and a wall cover another quarter.
  EXPECT_NEAR(lit({{square, &half},
                   {rectangle(0, 0.5, 0, 0.5), &tenth},
                   {rectangle(0.5, 1, 0, 0.5), nullptr},
                   {rectangle(0.5, 1, 0, 0.5), &tenth}}),
              0.5 * (0.5 + 0.25 * 0.1), 1e-15);
}

TEST(LitArea, OfRandomTrianglesIsThatOfPoints) {
  // 8 triangles are handled together, 60 are split in halves. The reference is 65,536 stratified points. Boundaries of
  // a length of about 30 in cells of 1/256 leave well below 2e-3.
  for (const std::uint32_t count : {8U, 60U}) {
    std::vector<Shade> shades;
    const Spectrum half = Spectrum::Constant(1, 0.5);
    const auto random = [&](std::uint32_t k, std::uint32_t d) { return hash({count, k, d}) * 0x1p-32; };
    for (std::uint32_t k = 0; k < count; ++k) {
      const Vector2d middle(random(k, 0), random(k, 1));
      PlanarOutline outline;
      for (std::uint32_t c = 0; c < 3; ++c)
        outline.push_back(middle + 0.4 * Vector2d(random(k, 2 + c) - 0.5, random(k, 5 + c) - 0.5));
      if (area_of(outline) < 0) std::swap(outline[0], outline[1]);
      shades.push_back({outline, k % 3 == 0 ? &half : nullptr});
    }
    constexpr int cells = 256;
    double sum = 0;
    for (int x = 0; x < cells; ++x) {
      for (int y = 0; y < cells; ++y) {
        const Vector2d point((x + 0.5) / cells, (y + 0.5) / cells);
        double share = 1;
        for (const Shade& shade : shades) {
          bool inside = true;
          for (std::size_t c = 0; c < 3; ++c) {
            const Vector2d way = shade.outline[(c + 1) % 3] - shade.outline[c];
            const Vector2d there = point - shade.outline[c];
            inside = inside && way.x() * there.y() - way.y() * there.x() >= 0;
          }
          if (inside) share *= shade.transmittance ? 0.5 : 0;
        }
        sum += share / (cells * cells);
      }
    }
    EXPECT_LT(sum, 0.99);
    EXPECT_NEAR(lit(shades), sum, 2e-3) << count;
  }
}

TEST(LitArea, OfTooManyShadowsInOnePlaceIsNotSaid) {
  // A fan around one point, which no bisection separates.
  std::vector<Shade> shades;
  for (int k = 0; k < 300; ++k) {
    const double angle = k * 2 * 3.14159265358979 / 300;
    shades.push_back({{Vector2d(0.3, 0.3), Vector2d(0.3, 0.3) + 0.2 * Vector2d(std::cos(angle), std::sin(angle)),
                       Vector2d(0.3, 0.3) + 0.2 * Vector2d(std::cos(angle + 0.01), std::sin(angle + 0.01))},
                      nullptr});
  }
  EXPECT_FALSE(lit_area(square, shades, 1));
}

}  // namespace
}  // namespace patchlight::lit_area_test
