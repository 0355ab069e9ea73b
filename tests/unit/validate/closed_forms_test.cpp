#include "validate/validate.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::validation {
namespace {

using std::numbers::pi;

// A form factor is a sum of terms of about 1, each rounded at 1e-16, over a width or two: 1e-13 is ample.
constexpr double rounding = 1e-13;

TEST(ClosedForms, UnitSquares) {
  EXPECT_NEAR(opposed_rectangles(1, 1, 1), 0.19982489569838732, rounding);
  EXPECT_NEAR(perpendicular_rectangles(1, 1, 1), 0.20004377607540316, rounding);
}

TEST(ClosedForms, TheAngledRectanglesContainThePerpendicularOnes) {
  for (const double w : {0.3, 1.0, 2.5}) {
    for (const double l : {0.5, 1.0, 4.0}) {
      EXPECT_NEAR(angled_rectangles(w, 1.2, l, pi / 2), perpendicular_rectangles(w, 1.2, l), 10 * rounding);
    }
  }
}

// Infinite strips have F = 1 - sin(angle / 2), Howell C-5. A strip of length l loses light at its ends: a fraction of
// about 1 / l.
TEST(ClosedForms, LongRectanglesAreStrips) {
  constexpr double l = 1e4;
  for (const double degrees : {1, 5, 30, 90, 150, 179}) {
    const double angle = degrees * pi / 180;
    EXPECT_NEAR(angled_rectangles(1, 1, l, angle), 1 - std::sin(angle / 2), 1 / l) << degrees;
  }
}

// Both rectangles send the same flux to each other: A_1 F_12 = A_2 F_21.
TEST(ClosedForms, AngledRectanglesAreReciprocal) {
  for (const double degrees : {1, 30, 120, 179}) {
    const double angle = degrees * pi / 180;
    EXPECT_NEAR(0.7 * angled_rectangles(0.7, 2, 1.5, angle), 2 * angled_rectangles(2, 0.7, 1.5, angle), 10 * rounding);
  }
}

// Five walls of a cube receive all light of the sixth.
TEST(ClosedForms, ACubeIsClosed) {
  EXPECT_NEAR(opposed_rectangles(1, 1, 1) + 4 * perpendicular_rectangles(1, 1, 1), 1, rounding);
}

// Equal discs that nearly touch lose the fraction h / r. A small one receives r^2 / (h^2 + r^2) from a large one, and
// discs far apart receive r^2 / h^2 from each other.
TEST(ClosedForms, DiscsNearAndFar) {
  EXPECT_NEAR(coaxial_discs(1, 1, 1e-6), 1, 2e-6);
  EXPECT_NEAR(coaxial_discs(1e-3, 2, 1), 4.0 / 5, 1e-6);
  EXPECT_NEAR(coaxial_discs(1, 1, 1e3) * 1e6, 1, 1e-5);
}

// Infinite cylinders: F_21 = r1 / r2. A fraction of about r2 / h leaves at the ends.
TEST(ClosedForms, LongCylinders) { EXPECT_NEAR(coaxial_cylinders(1, 3, 1e5), 1.0 / 3, 3e-5); }

// Above the element: the quadrant of the sky that starts directly above it. In front of it: a quarter, too, because the
// wall to the left and to the right covers half of the sky.
TEST(ClosedForms, ElementsBeforeLargeRectangles) {
  EXPECT_NEAR(element_to_parallel_rectangle(1e9, 1e9, 1), 0.25, 1e-8);
  EXPECT_NEAR(element_to_perpendicular_rectangle(1e9, 1e9, 1), 0.25, 1e-8);
}

}  // namespace
}  // namespace patchlight::validation
