#include "scene/repair.h"

#include "patchlight/base/error.h"

#include "mesh/mesher.h"
#include "support/diagnostics_of.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace patchlight::repair_test {
namespace {

using namespace test;

// Polygons on lines 1, 2, ...
Scene numbered(Scene scene) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) scene.polygons[p].line = p + 1;
  scene.file = "room.obj";
  return scene;
}

Scene one_polygon(const std::vector<Point>& corners) {
  return numbered(with_polygon(empty_scene({grey(0.5)}), corners));
}

double area(const Scene& scene) {
  double sum = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) sum += area_vector(corner_points(scene, p)).norm();
  return sum;
}

std::vector<DiagnosticCode> kinds(const Scene& scene) { return codes_of(scene.diagnostics); }

using Kinds = std::vector<DiagnosticCode>;

// Requirements of meshing: every patch has a positive area, and together they have the scene's.
void expect_meshable(const Scene& scene) {
  check(scene);
  const KeptSides sides = kept_sides(scene, Sides::front);
  double backs = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    backs += sides.back[p] * area_vector(corner_points(scene, p)).norm();
  }
  const double size = bounds(scene).diagonal().norm();
  const PatchMesh mesh = tessellate(scene, sides, size / 7);
  double sum = 0;
  for (const double patch_area : mesh.area) {
    EXPECT_GT(patch_area, 0);
    sum += patch_area;
  }
  EXPECT_NEAR(sum, area(scene) + backs, 1e-9 * size * size);
}

TEST(Repair, LeavesASoundSceneAsItIs) {
  const Scene scene = numbered(furnished_room(0.5));
  const Scene repaired = repair(scene);
  EXPECT_TRUE(repaired.diagnostics.empty());
  ASSERT_EQ(repaired.polygons.size(), scene.polygons.size());
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    EXPECT_EQ(corner_points(repaired, p), corner_points(scene, p));
    EXPECT_EQ(repaired.polygons[p].line, p + 1);
    EXPECT_EQ(repaired.polygons[p].face, p);
  }
  // Two boxes and a lamp: the faces of a box share its vertices.
  EXPECT_EQ(repaired.vertices.size(), 20U);
}

TEST(Repair, IsIdempotent) {
  Scene scene = with_quad(furnished_room(0.5), {Point(0, 0, 5), Point(1, 1, 5), Point(1, 0, 5), Point(0, 1, 5)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 7), Point(1, 0, 7), Point(1, 1, 7.2), Point(0, 1, 7)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(0, 0, 1e-9), Point(0, 1, 0), Point(0, 0.5, 0)});
  Scene once = repair(numbered(std::move(scene)));
  EXPECT_FALSE(once.diagnostics.empty());
  std::erase_if(once.diagnostics, [](const Diagnostic&) { return true; });
  const Scene twice = repair(once);
  EXPECT_TRUE(twice.diagnostics.empty());
  EXPECT_EQ(twice.polygons.size(), once.polygons.size());
}

TEST(Repair, WeldsWhatRoundingHasSetApart) {
  // Every face has its own corners, with errors up to half the weld distance of 4e-6.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-1e-6, 1e-6);
  Scene scene = furnished_room(0.5);
  for (Point& vertex : scene.vertices) vertex += Vector(jitter(random), jitter(random), jitter(random));
  const Scene repaired = repair(numbered(scene));
  EXPECT_EQ(repaired.vertices.size(), 20U);
  EXPECT_EQ(kinds(repaired), Kinds{DiagnosticCode::welded_vertices});
  EXPECT_EQ(repaired.diagnostics[0].count, scene.vertices.size() - 20);
  const KeptSides sides = kept_sides(repaired, Sides::automatic);
  EXPECT_EQ(std::count(sides.front.begin(), sides.front.begin() + 6, 1), 6);
  EXPECT_EQ(std::count(sides.back.begin(), sides.back.begin() + 12, 1), 0) << "the room and the box are closed";
  expect_meshable(repaired);
}

TEST(Repair, LeavesOutRepeatedCornersAndSpikes) {
  const Point a(0, 0, 0), b(1, 0, 0), c(1, 1, 0), d(0, 1, 0), away(3, 3, 0);
  for (const std::vector<Point>& corners : std::vector<std::vector<Point>>{{a, a, b, c, d},
                                                                           {a, b, c, d, a},
                                                                           {a, b, b, b, c, d, d},
                                                                           {a, b, c, away, c, d},
                                                                           {a, away, a, b, c, d},
                                                                           {away, a, b, c, d, a},
                                                                           {a, b, c, d, a, away}}) {
    const Scene repaired = repair(one_polygon(corners));
    ASSERT_EQ(repaired.polygons.size(), 1U);
    EXPECT_EQ(repaired.polygons[0].corners.size(), 4U);
    EXPECT_EQ(area(repaired), 1);
    EXPECT_EQ(kinds(repaired), Kinds{DiagnosticCode::repeated_corners});
    expect_meshable(repaired);
  }
  // A spike that ends in the middle of an edge, or continues along the next one.
  for (const Point& tip : {Point(0, 5, 0), Point(0, -2, 0)}) {
    const Scene repaired = repair(one_polygon({a, b, c, d, tip}));
    ASSERT_EQ(repaired.polygons.size(), 1U);
    EXPECT_EQ(area(repaired), 1);
    expect_meshable(repaired);
  }
}

TEST(Repair, LeavesOutFacesWithoutAreaAndCountsThem) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 1), Point(0, 0, 1), Point(0, 1, 1)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 1), Point(0.5, 0, 1), Point(1, 0, 1)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 1), Point(0.4, 3e-7, 1), Point(1, 0, 1), Point(0.7, -2e-7, 1)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 1), Point(1, 0, 1), Point(0, 0, 1), Point(0, 1, 1)});
  const Scene repaired = repair(numbered(std::move(scene)));
  EXPECT_EQ(repaired.polygons.size(), 1U);
  ASSERT_EQ(kinds(repaired), Kinds{DiagnosticCode::zero_area});
  const Diagnostic& problem = repaired.diagnostics[0];
  EXPECT_EQ(problem.count, 4U);
  EXPECT_NE(problem.text.find("room.obj:2"), std::string::npos) << problem.text;
  std::vector<std::uint32_t> lines;
  for (const ModelFace& face : problem.faces) lines.push_back(face.line);
  EXPECT_EQ(lines, (std::vector<std::uint32_t>{2, 3, 4, 5}));
}

TEST(Repair, OfTwoFacesWithOneFrontTheFirstStays) {
  const Quad quad = {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  for (int turn = 0; turn < 4; ++turn) {
    Quad again = quad;
    std::rotate(again.begin(), again.begin() + turn, again.end());
    const Scene scene = with_quad(with_quad(empty_scene({grey(0.5), grey(0.2)}), quad, 0), again, 1);
    const Scene repaired = repair(numbered(scene));
    ASSERT_EQ(repaired.polygons.size(), 1U);
    EXPECT_EQ(repaired.polygons[0].material, 0U);
    EXPECT_FALSE(repaired.polygons[0].back_material);
    ASSERT_EQ(kinds(repaired), Kinds{DiagnosticCode::duplicate_faces});
    EXPECT_NE(repaired.diagnostics[0].text.find(" 1 of "), std::string::npos);
  }
}

TEST(Repair, FacesBackToBackBecomeOneWithAMaterialOnEachSide) {
  const Quad quad = {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  for (int turn = 0; turn < 4; ++turn) {
    Quad back = {quad[3], quad[2], quad[1], quad[0]};
    std::rotate(back.begin(), back.begin() + turn, back.end());
    Scene scene = with_quad(with_quad(empty_scene({grey(0.5), grey(0.2, 3), grey(0.1)}), quad, 0), back, 1);
    scene = with_quad(std::move(scene), back, 2);
    const Scene repaired = repair(numbered(scene));
    ASSERT_EQ(repaired.polygons.size(), 1U);
    EXPECT_EQ(material_on(repaired.polygons[0], Side::front), 0U);
    EXPECT_EQ(material_on(repaired.polygons[0], Side::back), 1U) << "the first of those that face back";
    EXPECT_FALSE(emits(repaired, 0, Side::front));
    EXPECT_TRUE(emits(repaired, 0, Side::back));
    EXPECT_EQ(kinds(repaired), (Kinds{DiagnosticCode::duplicate_faces, DiagnosticCode::two_sided_faces}));
    expect_meshable(repaired);

    // Both sides are meshed, each with its material.
    const PatchMesh mesh = tessellate(repaired, kept_sides(repaired, Sides::front), 2);
    ASSERT_EQ(mesh.size(), 2U);
    EXPECT_EQ(mesh.material, (std::vector<MaterialIndex>{0, 1}));
  }
}

TEST(Repair, ALampBehindAFaceThatDoesNotEmitIsAnError) {
  const Quad quad = {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  const Scene covered = with_quad(with_quad(empty_scene({grey(0.5), grey(0, 3)}), quad, 0), quad, 1);
  EXPECT_EQ(kinds(repair(numbered(covered))), (Kinds{DiagnosticCode::covered_lamp, DiagnosticCode::duplicate_faces}));
  const Scene before = with_quad(with_quad(empty_scene({grey(0.5), grey(0, 3)}), quad, 1), quad, 0);
  EXPECT_EQ(kinds(repair(numbered(before))), Kinds{DiagnosticCode::duplicate_faces});
}

// Both halves of a folded square have half its area, for a fold along either diagonal.
TEST(Repair, CutsBentFacesIntoTrianglesWhereTheyBend) {
  for (const double height : {0.001, 0.1, 1.0, 10.0}) {
    const Scene fold = repair(one_polygon({Point(0, 0, 0), Point(1, 0, height), Point(1, 1, 0), Point(0, 1, height)}));
    EXPECT_EQ(fold.polygons.size(), 2U);
    EXPECT_EQ(kinds(fold), Kinds{DiagnosticCode::non_planar});
    EXPECT_EQ(fold.polygons[1].line, 1U);
    expect_meshable(fold);
  }
  // A bent hexagon: four triangles.
  std::vector<Point> corners;
  for (int k = 0; k < 6; ++k) corners.emplace_back(std::cos(k * M_PI / 3), std::sin(k * M_PI / 3), 0.1 * (k % 2));
  const Scene bent = repair(one_polygon(corners));
  EXPECT_EQ(bent.polygons.size(), 4U);
  expect_meshable(bent);
}

TEST(Repair, KeepsConcaveFacesWhole) {
  const Scene scene =
      one_polygon({Point(0, 0, 0), Point(2, 0, 0), Point(2, 1, 0), Point(1, 1, 0), Point(1, 2, 0), Point(0, 2, 0)});
  const Scene repaired = repair(scene);
  EXPECT_TRUE(repaired.diagnostics.empty());
  EXPECT_EQ(repaired.polygons.size(), 1U);
  expect_meshable(repaired);
}

// Wings of a bow-tie: two right isosceles triangles on a unit side, each of area 1/4. A pentagram with circumradius 1
// covers its five tips and its inner pentagon.
TEST(Repair, CutsFacesThatCrossThemselves) {
  const Scene bow_tie = repair(one_polygon({Point(0, 0, 0), Point(1, 1, 0), Point(1, 0, 0), Point(0, 1, 0)}));
  EXPECT_EQ(bow_tie.polygons.size(), 2U);
  EXPECT_DOUBLE_EQ(area(bow_tie), 0.5);
  EXPECT_EQ(front_normal(bow_tie, 0), front_normal(bow_tie, 1)) << "both wings face one way";
  EXPECT_EQ(bow_tie.diagnostics.at(0).code, DiagnosticCode::self_intersecting);
  expect_meshable(bow_tie);

  std::vector<Point> star;
  for (int k = 0; k < 5; ++k) star.emplace_back(std::cos(k * 0.8 * M_PI), std::sin(k * 0.8 * M_PI), 0);
  const Scene pentagram = repair(one_polygon(star));
  EXPECT_EQ(kinds(pentagram).front(), DiagnosticCode::self_intersecting);
  EXPECT_GT(pentagram.polygons.size(), 1U);
  expect_meshable(pentagram);
}

// Random closed curves, nearly all of which cross themselves: every result can be meshed.
TEST(Repair, MakesRandomPolygonsMeshable) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Point> corners;
    const double flatness = trial % 3 == 0 ? 1.0 : 0.0;
    for (int k = 0; k < 3 + trial % 9; ++k) {
      // Coordinates in quarters: corners and edges often touch.
      const double step = trial % 2 == 0 ? 0.25 : 1e-3;
      corners.emplace_back(step * std::round(uniform(random) / step), step * std::round(uniform(random) / step),
                           flatness * step * std::round(uniform(random) / step));
    }
    SCOPED_TRACE(trial);
    const Scene repaired = repair(one_polygon(corners));
    if (!repaired.polygons.empty()) expect_meshable(repaired);
  }
}

TEST(Repair, MakesPolygonsThatPassCornersTwiceMeshable) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    // Outlines of few points, so that most points occur twice. Every other trial lies in one plane.
    std::vector<Point> points;
    for (int k = 0; k < 5; ++k) points.emplace_back(uniform(random), uniform(random), trial % 2 * uniform(random));
    std::vector<Point> corners;
    for (int k = 0; k < 4 + trial % 6; ++k) corners.push_back(points[random() % points.size()]);
    const Scene repaired = repair(one_polygon(corners));
    if (!repaired.polygons.empty()) expect_meshable(repaired);
    ASSERT_FALSE(::testing::Test::HasFailure()) << "trial " << trial;
  }
}

TEST(Repair, CountsTurnedFacesAndBranchedEdges) {
  Scene scene = numbered(cube_room(0.5, 0));
  std::reverse(scene.polygons[4].corners.begin(), scene.polygons[4].corners.end());
  const Scene turned = repair(scene);
  ASSERT_EQ(kinds(turned), Kinds{DiagnosticCode::turned_faces});
  EXPECT_EQ(turned.diagnostics[0].faces.at(0).line, 5U);

  const Scene fin =
      repair(numbered(with_quad(cube_room(0.5, 0), {Point(0, 0, 1), Point(1, 0, 1), Point(1, 0, 2), Point(0, 0, 2)})));
  ASSERT_EQ(kinds(fin), Kinds{DiagnosticCode::non_manifold_edges});
  EXPECT_EQ(fin.diagnostics[0].count, 1U);
  EXPECT_EQ(fin.diagnostics[0].faces.size(), 3U);
}

// A polygon with holes, each joined to the outline by a seam: area and mesh are those of the outline minus the holes.
TEST(Repair, SeamsToHolesLeaveHoles) {
  const auto square = [](double x, double y, double size) {
    return std::vector<Point>{Point(x, y, 0), Point(x + size, y, 0), Point(x + size, y + size, 0),
                              Point(x, y + size, 0)};
  };
  // From a corner of the outline to the nearest corner of a hole, around it clockwise, and back.
  const auto with_hole = [](std::vector<Point> outline, std::size_t at, std::vector<Point> hole, std::size_t first) {
    std::reverse(hole.begin(), hole.end());
    std::rotate(hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(first), hole.end());
    hole.push_back(hole.front());
    hole.push_back(outline[at]);
    outline.insert(outline.begin() + static_cast<std::ptrdiff_t>(at) + 1, hole.begin(), hole.end());
    return outline;
  };
  const auto outer = square(0, 0, 4);
  const auto window = with_hole(outer, 0, square(1, 1, 1), 3);
  const auto two_windows = with_hole(window, window.size() - 2, square(2.5, 2.5, 1), 1);
  for (const auto& [corners, expected] : {std::pair{window, 15.0}, std::pair{two_windows, 14.0}}) {
    for (std::size_t start = 0; start < corners.size(); ++start) {
      auto rotated = corners;
      std::rotate(rotated.begin(), rotated.begin() + static_cast<std::ptrdiff_t>(start), rotated.end());
      const Scene repaired = repair(one_polygon(rotated));
      EXPECT_TRUE(repaired.diagnostics.empty());
      ASSERT_EQ(repaired.polygons.size(), 1U);
      EXPECT_DOUBLE_EQ(area(repaired), expected);
      expect_meshable(repaired);
    }
  }
}

TEST(Repair, DoesNotDependOnSizeAndPlace) {
  Scene scene = with_quad(furnished_room(0.5), {Point(0, 0, 5), Point(1, 1, 5), Point(1, 0, 5), Point(0, 1, 5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(0, 3, 0), Point(4, 3, 0), Point(4, 0, 0)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 7), Point(1, 0, 7), Point(1, 1, 7.2), Point(0, 1, 7)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 8), Point(1, 0, 8), Point(2, 0, 8)});
  scene = numbered(std::move(scene));
  const Scene here = repair(scene);
  ASSERT_GE(here.diagnostics.size(), 4U);
  const Eigen::Affine3d turn(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  const Eigen::Affine3d far(Eigen::Translation3d(1e6, -1e6, 1e6));
  const Eigen::Affine3d small(Eigen::UniformScaling<double>(1e-3));
  const Eigen::Affine3d large(Eigen::UniformScaling<double>(1e3));
  for (const Eigen::Affine3d& motion : {turn, far, small, large}) {
    const Scene there = repair(moved(scene, motion));
    EXPECT_EQ(kinds(there), kinds(here));
    for (std::size_t k = 0; k < here.diagnostics.size(); ++k)
      EXPECT_EQ(there.diagnostics[k].count, here.diagnostics[k].count);
    EXPECT_EQ(there.polygons.size(), here.polygons.size());
    EXPECT_EQ(there.vertices.size(), here.vertices.size());
  }
}

TEST(Repair, RefusesWhatIsNoGeometry) {
  Scene scene = numbered(cube_room(0.5, 0));
  scene.polygons[2].corners[1] = 99;
  EXPECT_THROW(repair(scene), InputError);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    Scene wrong = numbered(cube_room(0.5, 0));
    wrong.vertices[3].y() = bad;
    EXPECT_THROW(repair(wrong), InputError);
  }
}

// Most faces are so small compared with the largest that rays cannot distinguish them. The small ones are removed. The
// large one is not removed as distant from most of the model.
TEST(Repair, LeavesOutFacesThatAreNothingBesideTheRest) {
  for (const double unit : {1.0, 1e-3}) {
    for (const double small : {1e-13, 2e-20, 2.278e-41}) {
      const double a = small * unit;
      Scene scene = empty_scene({grey(0.5, 1)});
      scene = with_polygon(std::move(scene), {Point(0, 0, 0), Point(unit, 0, 0), Point(unit, unit, 0)});
      scene = with_polygon(std::move(scene), {Point(0, 0, 0), Point(0, a, a), Point(0, 0, a)});
      scene = with_polygon(std::move(scene), {Point(0, 0, 0), Point(a, 0, a), Point(a, a, a)});
      scene = with_polygon(std::move(scene), {Point(0, 0, 0), Point(a, a, a), Point(a, a, 0)});
      const Scene repaired = repair(std::move(scene));
      ASSERT_EQ(repaired.polygons.size(), 1U) << unit << ' ' << small;
      EXPECT_EQ(corner_points(repaired, 0)[1], Point(unit, 0, 0));
    }
  }
}

}  // namespace
}  // namespace patchlight::repair_test
