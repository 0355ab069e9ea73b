#include "patchlight/plan/plan.h"

#include "lighting/direct_irradiance.h"
#include "lighting/lighting.h"
#include "mesh/mesher.h"
#include "plan/planned_lines.h"
#include "scene/repair.h"
#include "support/diagnostics_of.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

namespace patchlight::shadow_lines_test {
namespace {

using namespace test;

// A floor of 4 x 4 m at z = 0, its front upward: polygon 0. The sun gives 1 W/m^2 to a patch that faces it.
Scene sunny_floor(const Vector& sun) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
  scene.sun = Sun{sun.normalized(), Spectrum::Constant(1, 1)};
  return scene;
}

// Its faces share their edges.
Scene with_block(Scene scene, const Point& a, const Point& b) {
  return repair(with_box(std::move(scene), a, b, false));
}

double length_of(const std::vector<ContactLine>& lines) {
  double length = 0;
  for (const ContactLine& line : lines) length += (line.to - line.from).norm();
  return length;
}

struct LitFloor {
  double area = 0;    // m^2 of the floor's patches, weighted by their lit fraction
  double partly = 0;  // m^2 of patches that are neither lit nor dark
  double patches = 0;
};

// Polygon 0 of a scene in the planned mesh, by the irradiance of a light that reaches every lit patch.
LitFloor lit_floor(const Scene& scene, Request request) {
  request.mesh.sides = Sides::front;
  const Plan plan = make_plan(scene, request);
  const PatchMesh mesh = tessellate(scene, plan.sides, plan.max_edge, plan.contacts);
  const Field irradiance = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh, {}).irradiance;
  Scene open = scene;
  open.polygons.resize(1);
  const Field unshadowed = direct_irradiance(lighting_of(open, Tracing(open)), mesh, {}).irradiance;
  constexpr double rounding = 1e-4;
  LitFloor floor;
  for (PatchIndex i = mesh.first_patch[0]; i < mesh.first_patch[1]; ++i) {
    const double lit = irradiance(i, 0) / unshadowed(i, 0);
    floor.area += lit * mesh.area[i];
    if (lit > rounding && lit < 1 - rounding) floor.partly += mesh.area[i];
  }
  return floor;
}

Request patches(std::size_t number) {
  Request request;
  request.mesh.patches = number;
  return request;
}

std::vector<ContactLine> lines_on_floor(const Scene& scene) {
  const std::size_t count = scene.polygons.size();
  const KeptSides front{std::vector<std::uint8_t>(count, 1), std::vector<std::uint8_t>(count, 0), {}, {}};
  return find_shadow_lines(scene, front, find_coverings(scene, front), {{scene.sun->direction, 0}})[0];
}

}  // namespace

// A block of 1 m below a sun at 45 degrees, parallel to its faces. An edge of the top casts the end of the shadow. An
// edge of the top and two vertical edges cast each side, one of them along the foot of the block.
TEST(ShadowLines, RunAroundTheShadowOfABlock) {
  const Scene scene = with_block(sunny_floor({-1, 0, 1}), Point(1, 1, 0), Point(2, 2, 1));
  const std::vector<ContactLine> lines = lines_on_floor(scene);
  EXPECT_NEAR(length_of(lines), 1 + 2 * 3, 1e-4);
  for (const ContactLine& line : lines) {
    EXPECT_EQ(line.gap, 0);
    EXPECT_NEAR(line.from.z(), 0, 1e-12);
    EXPECT_NEAR(line.to.z(), 0, 1e-12);
  }
}

// The vertical edges of a block that is oblique to the sun cast the sides of its shadow.
TEST(ShadowLines, AreThrownBySilhouettesAlone) {
  const Scene scene = with_block(sunny_floor({-1, -1, 1}), Point(1, 1, 0), Point(2, 2, 1));
  EXPECT_NEAR(length_of(lines_on_floor(scene)), 2 * std::numbers::sqrt2 + 2, 1e-4);
}

// Without lines, patches in half shadow cover a twentieth of the floor or more.
TEST(ShadowLines, LeaveNoPatchInHalfShadow) {
  const Scene scene = with_block(sunny_floor({-1, -0.6, 1.1}), Point(1, 1, 0), Point(2, 2, 1));
  const double shadow = 1.0 + 1 / 1.1 * (1 + 0.6);  // the block's foot, and the shadow of its top
  const LitFloor with = lit_floor(scene, patches(400));
  EXPECT_EQ(with.partly, 0);
  EXPECT_NEAR(with.area, 16 - shadow, 1e-4 * 16);
  Request without = patches(400);
  without.mesh.contact_lines = false;
  EXPECT_GT(lit_floor(scene, without).partly, 0.05 * 16);
}

// A board over the block: the shadow's outline changes from one's edges to the other's between their ends, and lines
// end on lines.
TEST(ShadowLines, EndWhereShadowsMeet) {
  Scene scene = with_block(sunny_floor({-1, -0.6, 1.1}), Point(1, 1, 0), Point(2, 2, 1));
  scene = with_block(std::move(scene), Point(0.3, 1.7, 0.6), Point(2.6, 2.1, 0.65));
  EXPECT_LE(lit_floor(scene, patches(400)).partly, 2e-3 * 16);
}

TEST(ShadowLines, AreThoseOfALuminaireWithoutExtentToo) {
  Scene scene = with_block(sunny_floor({-1, 0, 1}), Point(1, 1, 0), Point(2, 2, 0.5));
  scene.sun.reset();
  Luminaire bulb;
  bulb.position = Point(0.4, 2.6, 2);
  bulb.light = PointLight{Spectrum::Constant(1, 1)};
  scene.luminaires = {bulb};
  EXPECT_EQ(lit_floor(scene, patches(400)).partly, 0);
}

// The shadow of a post at the inner corner of an L continues where an edge of the floor ends.
TEST(ShadowLines, GoOnBeyondAnEdgeOfTheFloor) {
  Scene scene = with_polygon(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 2, 0), Point(2, 2, 0),
                                                        Point(2, 4, 0), Point(0, 4, 0)});
  scene = with_quad(std::move(scene), {Point(2, 2, 0), Point(4, 2, 0), Point(4, 2, 1), Point(2, 2, 1)});
  scene.sun = Sun{Vector(0, 1, 1).normalized(), Spectrum::Constant(1, 1)};
  const std::vector<ContactLine> lines = lines_on_floor(scene);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const ContactLine& line) {
    return std::abs(line.from.x() - 2) < 1e-9 && std::abs(line.to.x() - 2) < 1e-9 &&
           std::abs(std::abs(line.from.y() - line.to.y()) - 1) < 1e-3;
  }));
}

// An edge that rises above the light casts an infinite shadow there.
TEST(ShadowLines, EndAtTheHeightOfTheLight) {
  Scene scene = with_block(sunny_floor({-1, 0, 1}), Point(1, 1, 0), Point(1.1, 1.1, 3));
  const std::size_t count = scene.polygons.size();
  const KeptSides front{std::vector<std::uint8_t>(count, 1), std::vector<std::uint8_t>(count, 0), {}, {}};
  const auto lines = find_shadow_lines(scene, front, find_coverings(scene, front), {{Point(0.5, 0.9, 2), 1}})[0];
  EXPECT_FALSE(lines.empty());
  for (const ContactLine& line : lines) {
    EXPECT_GE(std::min(line.from.x(), line.to.x()), 0.99) << "to the far side of the light";
    EXPECT_GT(std::max(line.from.x(), line.to.x()), 3) << "out to the floor's edge";
  }
}

// The ceiling does not hide a luminaire flush with it.
TEST(ShadowLines, AreThrownByALightInThePlaneOfTheCeiling) {
  Scene scene = with_block(sunny_floor({-1, 0, 1}), Point(1, 1, 0), Point(2, 2, 0.5));
  scene = with_quad(std::move(scene), {Point(0, 0, 2.3), Point(0, 4, 2.3), Point(4, 4, 2.3), Point(4, 0, 2.3)});
  const std::size_t count = scene.polygons.size();
  const KeptSides front{std::vector<std::uint8_t>(count, 1), std::vector<std::uint8_t>(count, 0), {}, {}};
  const auto lines = find_shadow_lines(scene, front, find_coverings(scene, front), {{Point(0.3, 0.4, 2.3), 1}})[0];
  // The shadows of two edges of the top, of 1 m each, are longer by the ratio of distances to the light.
  double longest = 0;
  for (const ContactLine& line : lines) longest = std::max(longest, (line.to - line.from).norm());
  EXPECT_NEAR(longest, 2.3 / 1.8, 1e-4);
}

// Disabled effects, a set sun and many luminaires give no lines. Neither does a mesh of given form factors, which do
// not depend on light.
TEST(ShadowLines, AreFollowedWhereTheyTellOfMuchLight) {
  Scene scene = with_block(sunny_floor({-1, -0.6, 1.1}), Point(1, 1, 0.5), Point(2, 2, 1));
  scene.sky = Sky{.horizontal_irradiance = Spectrum::Constant(1, 1)};
  EXPECT_GT(number_of(make_plan(scene, {}).contacts), 0U);
  Request request;
  request.effects.skip = {Effect::sun};
  EXPECT_EQ(number_of(make_plan(scene, request).contacts), 0U);
  EXPECT_EQ(number_of(make_plan(scene, {}, {.form_factors = true}).contacts), 0U);
  EXPECT_EQ(number_of(plan_form_factors(scene, {}).contacts), 0U);
  scene.sun->direction.z() *= -1;
  EXPECT_EQ(number_of(make_plan(scene, {}).contacts), 0U);
  scene.sun.reset();
  Luminaire bulb;
  bulb.position = Point(0.4, 2.6, 2);
  bulb.light = PointLight{Spectrum::Constant(1, 1)};
  scene.luminaires.assign(4, bulb);
  EXPECT_GT(number_of(make_plan(scene, {}).contacts), 0U);
  scene.luminaires.assign(5, bulb);
  EXPECT_EQ(number_of(make_plan(scene, {}).contacts), 0U);
}

// Two crossing grilles of 80 flat bars over a floor cast shadows of thousands of corners.
TEST(ShadowLines, AreLeftOutWhereTheyAreTooMany) {
  Scene scene = sunny_floor({-0.1, -0.2, 1});
  for (int k = 0; k < 80; ++k) {
    const double x = 0.05 * k;
    scene = with_quad(std::move(scene), {Point(x, 0, 1), Point(x + 0.02, 0, 1), Point(x + 0.02, 4, 1), Point(x, 4, 1)});
    scene = with_quad(std::move(scene), {Point(0, x, 2), Point(4, x, 2), Point(4, x + 0.02, 2), Point(0, x + 0.02, 2)});
  }
  const Plan plan = make_plan(scene, patches(100));
  EXPECT_TRUE(has(plan.notes, DiagnosticCode::shadow_edges));
  EXPECT_EQ(number_of(plan.contacts), 0U);
}

}  // namespace patchlight::shadow_lines_test
