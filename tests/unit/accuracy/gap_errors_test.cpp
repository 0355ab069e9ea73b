#include "accuracy/errors.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <gtest/gtest.h>
#include <utility>

namespace patchlight::gap_errors_test {
namespace {

using namespace test;

// Two squares of 1 m^2, one patch each, that face each other at a distance.
PatchMesh two_squares(double distance) {
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene),
                    {Point(0, 0, distance), Point(0, 1, distance), Point(1, 1, distance), Point(1, 0, distance)});
  return tessellate(scene, kept_sides(scene, Sides::front), 2);
}

// Half of the rays of the first square meet the other one as hits, and a fraction of all rays as an entry.
RayTransport transport_with(float entry) {
  RayRows rows;
  rows.first_hit = {0, 1, 1};
  rows.hits = {1};
  rows.hit_weight = {0.5, 0};
  rows.first_entry = {0, 1, 1};
  rows.entries = {{1, entry}};
  return RayTransport({rows, rows});
}

double error_of_first(double distance, float entry, int cuts = 0) {
  const RadiosityProblem problem;
  Solution solution;
  solution.irradiance = Field::Constant(2, 1, 3);
  solution.radiosity = Field::Constant(2, 1, 6);  // the dark rest of the hemisphere makes this the range
  const Field errors = gap_errors(two_squares(distance), transport_with(entry), {problem, solution}, cuts);
  EXPECT_EQ(errors(1, 0), 0) << "no ray of it meets anything";
  return errors(0, 0);
}

// H / 2 times the fraction of near faces beyond 0.35.
TEST(GapErrors, GrowWithTheShareOfNearFacesThatRaysMeet) {
  EXPECT_NEAR(error_of_first(0.01, 0.48F), 1.5 * (0.98 - 0.35) / 0.65, 1e-6);
  EXPECT_NEAR(error_of_first(0.59, 0), 1.5 * (0.5 - 0.35) / 0.65, 1e-6);
}

TEST(GapErrors, AreNoneOfFacesThatAreNotNear) { EXPECT_EQ(error_of_first(0.61, 0.48F), 0); }

// Three cuts leave edges of an eighth: 0.6 of that is 0.075.
TEST(GapErrors, ThatCutsDoNotMendAreThoseOfFacesWhichStayNear) {
  EXPECT_EQ(error_of_first(0.076, 0.48F, 3), 0);
  EXPECT_EQ(error_of_first(0.074, 0.48F, 3), error_of_first(0.074, 0.48F));
}

}  // namespace
}  // namespace patchlight::gap_errors_test
