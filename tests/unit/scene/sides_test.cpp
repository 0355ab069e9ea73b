#include "patchlight/scene/sides.h"

#include "support/diagnostics_of.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

namespace patchlight::sides_test {
namespace {

constexpr MaterialIndex wall = 0;
constexpr MaterialIndex lamp = 1;

Scene empty_scene() {
  Scene scene;
  scene.file = "room.obj";
  scene.materials = {{"wall", rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}, {"lamp", rgb(0, 0, 0), rgb(1, 1, 1)}};
  scene.groups = {"all"};
  return scene;
}

// Every polygon has its own vertices, a common practice of exporters.
Scene with_polygon(Scene scene, const std::vector<Point>& points, MaterialIndex material = wall) {
  Polygon polygon;
  for (const Point& point : points) {
    polygon.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
    scene.vertices.push_back(point);
  }
  polygon.material = material;
  polygon.line = static_cast<std::uint32_t>(scene.polygons.size()) + 1;
  scene.polygons.push_back(polygon);
  return scene;
}

enum class Normals { outward, inward };

Scene with_cube(Scene scene, const Point& centre, double size, Normals normals) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector n = sign * Vector::Unit(axis);
      const Vector u = Vector::Unit((axis + 1) % 3);
      const Vector v = n.cross(u);  // u x v = n
      std::vector<Point> corners;
      for (const auto& [s, t] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        corners.emplace_back(centre + size / 2 * (n + s * u + t * v));
      }
      if (normals == Normals::inward) std::reverse(corners.begin(), corners.end());
      scene = with_polygon(std::move(scene), corners);
    }
  }
  return scene;
}

// A small square lamp whose front faces down.
Scene with_lamp(Scene scene, const Point& centre, double size = 0.1) {
  const double h = size / 2;
  return with_polygon(
      std::move(scene),
      {centre + Vector(-h, -h, 0), centre + Vector(-h, h, 0), centre + Vector(h, h, 0), centre + Vector(h, -h, 0)},
      lamp);
}

// Six distant sheets around everything, so that every side has something before it.
Scene among_others(Scene scene) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double at : {-9.0, 9.0}) {
      const Vector u = Vector::Unit((axis + 1) % 3);
      const Vector v = Vector::Unit((axis + 2) % 3);
      const Point middle = at * Vector::Unit(axis);
      scene = with_polygon(std::move(scene), {middle, middle + u, middle + v});
    }
  }
  return scene;
}

using Pair = std::pair<int, int>;

// Front and back of a polygon.
Pair sides_of(const KeptSides& kept, PolygonIndex polygon) { return {kept.front[polygon], kept.back[polygon]}; }

constexpr Pair front_only = {1, 0};
constexpr Pair back_only = {0, 1};
constexpr Pair both_sides = {1, 1};
constexpr Pair no_side = {0, 0};

void expect_all(const KeptSides& kept, PolygonIndex begin, PolygonIndex end, const Pair& expected) {
  for (PolygonIndex p = begin; p < end; ++p) EXPECT_EQ(sides_of(kept, p), expected) << "polygon " << p;
}

KeptSides automatic(const Scene& scene) { return kept_sides(scene, Sides::automatic); }

TEST(KeptSides, FrontAndBothDoNotLookAtTheScene) {
  const Scene scene = with_lamp(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward), {0, 0, 0});
  const KeptSides front = kept_sides(scene, Sides::front);
  expect_all(front, 0, 7, front_only);
  EXPECT_FALSE(front.emit_from_back);
  const KeptSides both = kept_sides(scene, Sides::both);
  expect_all(both, 0, 7, both_sides);
  EXPECT_TRUE(both.emit_from_back);
  EXPECT_EQ(test::codes_of(both.notes), std::vector{DiagnosticCode::both_sides}) << "the doubled flux is reported";
}

TEST(KeptSides, ASolidWithoutALampKeepsItsOuterSides) {
  const Scene outward = among_others(with_lamp(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward), {0, 0, 2}));
  expect_all(automatic(outward), 0, 6, front_only);
  const Scene inward = among_others(with_lamp(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward), {0, 0, 2}));
  expect_all(automatic(inward), 0, 6, back_only);
  EXPECT_EQ(sides_of(automatic(outward), 6), both_sides) << "the lamp is no solid";
  EXPECT_FALSE(automatic(outward).emit_from_back);
}

// A lamp over an open box. There is light inside. Nothing is before the outer sides, except the lamp's own.
TEST(KeptSides, ASideWithNothingBeforeItIsDark) {
  for (const double metres : {1.0, 1000.0}) {
    Scene scene = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward);
    scene.polygons.pop_back();  // that at high z
    scene = with_lamp(std::move(scene), {0, 0, 0.7});
    const Eigen::AngleAxisd rotation(1.1, Vector(0.3, 1, -2).normalized());
    for (Point& vertex : scene.vertices) vertex = metres * (rotation * vertex);
    const KeptSides kept = automatic(scene);
    expect_all(kept, 0, 6, front_only);
    EXPECT_EQ(kept.turned_away, 6U);
    expect_all(kept_sides(scene, Sides::automatic, {.turned_away = true}), 0, 6, both_sides);
    scene.sky = Sky{};
    expect_all(automatic(scene), 0, 6, both_sides);
    scene.sky.reset();
    scene.luminaires.resize(1);
    scene.luminaires[0].position = metres * (rotation * Point(2, 0, 0));
    EXPECT_EQ(sides_of(automatic(scene), 1), both_sides) << "the wall at high x is lit from outside";
    EXPECT_EQ(sides_of(automatic(scene), 0), front_only);
  }
}

TEST(KeptSides, ASolidAroundTheOnlyLampKeepsItsInnerSides) {
  const KeptSides outward = automatic(with_lamp(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward), {0, 0, 0.2}));
  expect_all(outward, 0, 6, back_only);
  EXPECT_TRUE(test::has(outward.notes, DiagnosticCode::outward_normals));
  const KeptSides inward = automatic(with_lamp(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward), {0, 0, 0.2}));
  expect_all(inward, 0, 6, front_only);
}

// A note reports a lamp 20 cm above the ceiling, which lights no room, and its position. There is no note for a lamp
// beside a cupboard in the room.
TEST(KeptSides, TellOfALuminaireOutsideOfTheRoom) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward);
  const double ceiling = bounds(scene).max().z();
  const auto told = [&](const Point& position) {
    scene.luminaires = {
        {.name = "bulb", .place = "a.toml:7", .position = position, .light = PointLight{Spectrum::Ones(1)}}};
    for (const Diagnostic& found : kept_sides(scene, Sides::automatic).notes)
      if (found.code == DiagnosticCode::misplaced_luminaire) return found.text;
    return std::string();
  };
  EXPECT_EQ(told({0, 0, ceiling + 0.2}),
            "no luminaire stands in the room: 'bulb' (a.toml:7) is the nearest, 0.2 m outside");
  EXPECT_EQ(told({0, 0, ceiling - 0.1}), "");
  EXPECT_EQ(told({0, 0, ceiling + 5}), "") << "as a street lamp may stand";
  scene = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward);
  EXPECT_EQ(told({0, 0, ceiling + 0.2}), "") << "a block";
  scene = with_cube(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward), {0, 0, 0}, 0.2, Normals::outward);
  EXPECT_EQ(told({0, 0, ceiling - 0.1}), "");
}

// A room with a lamp under the sky: a note explains that daylight has no effect in it.
TEST(KeptSides, SaysWhereNoDaylightGetsIn) {
  const auto says_so = [](const Scene& scene) {
    return test::has(automatic(scene).notes, DiagnosticCode::sealed_solid);
  };
  Scene scene = with_lamp(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward), {0, 0, 0.2});
  EXPECT_FALSE(says_so(scene)) << "there is none";
  scene.sky = Sky{};
  EXPECT_TRUE(says_so(scene));
  scene.polygons.erase(scene.polygons.begin());
  EXPECT_FALSE(says_so(scene)) << "one wall is open";
}

TEST(KeptSides, ALuminaireIsALampWhereItStands) {
  Scene scene = among_others(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward));
  scene.luminaires.resize(1);
  scene.luminaires[0].position = {0, 0, 0.2};
  expect_all(automatic(scene), 0, 6, front_only);
  scene.luminaires[0].position = {0, 0, 2};
  expect_all(automatic(scene), 0, 6, back_only);
}

TEST(KeptSides, DaylightGetsInThroughOpeningsOnly) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward);
  scene.sky = Sky{};
  expect_all(automatic(scene), 0, 6, back_only);
  scene.materials.push_back({"glass", rgb(0, 0, 0), rgb(0, 0, 0), rgb(0.8, 0.8, 0.8)});
  scene.polygons[3].material = 2;
  expect_all(automatic(scene), 0, 6, both_sides);
}

TEST(KeptSides, LightGetsThroughSheetsBothSidesOfWhichTakePart) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward);
  Material paper{"paper", rgb(0.3, 0.3, 0.3), rgb(0, 0, 0)};
  paper.diffuse_transmittance = rgb(0, 0, 0.5);
  scene.materials.push_back(paper);
  scene.polygons[3].material = 2;
  const Scene dark = scene;
  scene.sky = Sky{};
  expect_all(automatic(scene), 0, 6, both_sides);
  // A lamp inside. Among the sides that face away from the solid, with nothing before them, only that of the sheet is
  // kept.
  const KeptSides lit = automatic(with_lamp(dark, {0, 0, 0.2}));
  for (std::size_t p = 0; p < 6; ++p) {
    EXPECT_TRUE(lit.front[p]);
    EXPECT_EQ(lit.back[p] != 0, p == 3) << p;
  }
  const KeptSides fronts = kept_sides(dark, Sides::front);
  EXPECT_EQ(fronts.back, (std::vector<std::uint8_t>{0, 0, 0, 1, 0, 0}));
}

TEST(KeptSides, ASolidAroundOneOfTwoLampsKeepsBothSides) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward);
  scene = among_others(with_lamp(with_lamp(std::move(scene), {0, 0, 0.2}), {0, 0, 2}));
  expect_all(automatic(scene), 0, 6, both_sides);
}

TEST(KeptSides, ALampThatIsPartOfTheShellShinesWhereItsFrontLooks) {
  Scene inward = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::inward);
  inward.polygons[5].material = lamp;
  expect_all(automatic(inward), 0, 6, front_only);
  Scene outward = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward);
  outward.polygons[5].material = lamp;
  expect_all(automatic(among_others(std::move(outward))), 0, 6, front_only);
}

TEST(KeptSides, ARoomHoldsItsFurniture) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 4, Normals::inward);        // 0 to 5: the room
  scene = with_cube(std::move(scene), {0, 0, -1}, 1, Normals::outward);         // 6 to 11: a solid
  scene = with_lamp(std::move(scene), {0, 0, 1.5});                             // 12
  scene = with_polygon(std::move(scene), {{1, 1, 0}, {1.5, 1, 0}, {1, 1, 1}});  // 13: a sheet
  const KeptSides kept = automatic(scene);
  expect_all(kept, 0, 12, front_only);
  expect_all(kept, 12, 14, both_sides);
}

TEST(KeptSides, ATurnedFaceOfASolidKeepsTheSideThatItsNeighboursKeep) {
  Scene scene = among_others(with_lamp(with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward), {0, 0, 2}));
  std::reverse(scene.polygons[2].corners.begin(), scene.polygons[2].corners.end());
  const KeptSides kept = automatic(scene);
  expect_all(kept, 0, 2, front_only);
  expect_all(kept, 2, 3, back_only);
  expect_all(kept, 3, 6, front_only);
}

TEST(KeptSides, ABackThatIsAFaceOfItsOwnIsKeptAndMayBeALamp) {
  // Two plates, and the back of the second is a lamp. It is in the same cube as a point behind it.
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 2, Normals::outward);
  scene = with_polygon(std::move(scene), {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}});
  scene.polygons[6].back_material = lamp;
  EXPECT_TRUE(is_lamp(scene, 6));
  EXPECT_FALSE(emits(scene, 6, Side::front));
  EXPECT_EQ(sides_of(kept_sides(scene, Sides::front), 6), both_sides);
  EXPECT_EQ(sides_of(kept_sides(scene, Sides::front), 0), front_only);
  const KeptSides kept = automatic(scene);
  expect_all(kept, 0, 6, back_only);
  EXPECT_EQ(sides_of(kept, 6), both_sides);
}

TEST(KeptSides, AnOpenOrBranchedSurfaceKeepsEverything) {
  Scene open = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward);
  open.polygons.pop_back();
  expect_all(automatic(open), 0, 5, both_sides);

  // Two cubes that share an edge: four polygons meet there.
  Scene branched = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward);
  branched = with_cube(std::move(branched), {1, 1, 0}, 1, Normals::outward);
  expect_all(automatic(branched), 0, 12, both_sides);

  // A sheet modeled as two coincident polygons encloses nothing.
  Scene fold = with_polygon(empty_scene(), {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  fold = with_polygon(std::move(fold), {{0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0, 0, 0}});
  expect_all(automatic(fold), 0, 2, both_sides);
}

// A floor of two triangles from -2 to 2 at this height, whose front faces up.
Scene with_floor(Scene scene, double height) {
  scene = with_polygon(std::move(scene), {{-2, -2, height}, {2, -2, height}, {2, 2, height}});
  return with_polygon(std::move(scene), {{-2, -2, height}, {2, 2, height}, {-2, 2, height}});
}

// A unit cube around the origin with a lamp above it. The parameters select the faces that face along +-z.
Scene lit_tube(bool bottom, bool top) {
  Scene scene = with_cube(with_lamp(empty_scene(), {0, 0, 1.5}), {0, 0, 0}, 1, Normals::outward);
  if (!top) scene.polygons.erase(scene.polygons.begin() + 6);
  if (!bottom) scene.polygons.erase(scene.polygons.begin() + 5);
  return scene;
}

TEST(KeptSides, AFaceClosesWhatStandsOnIt) {
  const KeptSides kept = automatic(with_floor(lit_tube(false, true), -0.5));
  expect_all(kept, 1, 6, front_only);
  ASSERT_EQ(kept.dark_solids.size(), 1U);
  EXPECT_EQ(kept.dark_solids[0].polygons, 5U);
  // A column is closed at both ends. So is a tube on its side with a wall at its end.
  const KeptSides column = automatic(with_floor(with_floor(lit_tube(false, false), -0.5), 0.5));
  expect_all(column, 1, 5, front_only);
  const Eigen::Affine3d turned(Eigen::AngleAxisd(1.1, Vector(1, 2, -1).normalized()));
  Scene on_wall = with_floor(lit_tube(false, true), -0.5);
  for (Point& vertex : on_wall.vertices) vertex = turned * (1000 * vertex) + Vector(3e5, 0, -2e4);
  expect_all(automatic(on_wall), 1, 6, front_only);
}

// A room of 4 m with a lamp and a wall across it, 0.2 m thick: two faces with a doorway each, and the three faces of
// its reveal. It ends at the floor on both sides of the door, at the ceiling and at two walls. It is `gap` m above the
// floor.
Scene room_with_doorway(double gap) {
  Scene scene = with_lamp(with_cube(empty_scene(), {0, 0, 0}, 4, Normals::inward), {1, 0, 1.5});
  const double low = -2 + gap;
  const std::vector<Point> outline = {{0, -2, low},  {0, -0.5, low}, {0, -0.5, 0.2}, {0, 0.5, 0.2},
                                      {0, 0.5, low}, {0, 2, low},    {0, 2, 2},      {0, -2, 2}};
  std::vector<Point> back;
  for (const Point& corner : outline) back.insert(back.begin(), corner - Vector(0.2, 0, 0));
  scene = with_polygon(std::move(scene), outline);
  scene = with_polygon(std::move(scene), back);
  for (const std::size_t k : {1, 2, 3}) {
    const Vector through(-0.2, 0, 0);
    scene =
        with_polygon(std::move(scene), {outline[k + 1], outline[k], outline[k] + through, outline[k + 1] + through});
  }
  return scene;
}

TEST(KeptSides, FacesInSeveralPlanesCloseAWallWithADoor) {
  const KeptSides kept = automatic(room_with_doorway(0));
  expect_all(kept, 7, 12, front_only);
  ASSERT_EQ(kept.dark_solids.size(), 1U);
  EXPECT_EQ(kept.dark_solids[0].polygons, 5U);
  expect_all(automatic(room_with_doorway(0.001)), 7, 12, both_sides);
}

TEST(KeptSides, WhatIsNotClosedByWhatItStandsOnKeepsItsInsides) {
  expect_all(automatic(with_floor(lit_tube(false, true), -0.501)), 1, 6, both_sides);
  expect_all(automatic(with_floor(lit_tube(false, false), -0.5)), 1, 5, both_sides);
  // The floor ends under the block.
  Scene half = with_floor(lit_tube(false, true), -0.5);
  half.polygons.pop_back();
  expect_all(automatic(half), 1, 6, both_sides);
  // A pane.
  Scene pane = with_floor(lit_tube(false, true), -0.5);
  pane.materials.push_back({"clear", rgb(0, 0, 0), rgb(0, 0, 0)});
  pane.materials.back().transmittance = rgb(1, 1, 1);
  pane.polygons.back().material = 2;
  ASSERT_TRUE(is_opening(pane, static_cast<PolygonIndex>(pane.polygons.size() - 1)));
  expect_all(automatic(pane), 1, 6, both_sides);
  // A lamp inside, and the luminous floor itself.
  expect_all(automatic(with_lamp(with_floor(lit_tube(false, true), -0.5), {0, 0, 0})), 1, 6, both_sides);
  Scene luminous = with_floor(lit_tube(false, true), -0.5);
  luminous.polygons.back().material = lamp;
  expect_all(automatic(luminous), 1, 6, both_sides);
}

TEST(KeptSides, TouchingAtACornerDoesNotJoinSolids) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward);
  scene = with_cube(std::move(scene), {1, 1, 1}, 1, Normals::inward);
  const KeptSides kept = automatic(scene);
  expect_all(kept, 0, 6, front_only);
  expect_all(kept, 6, 12, back_only);
}

// A lit room with the lamp, and a dark one that contains a box and a sheet. The sheet ends at a wall.
Scene lit_and_dark_room() {
  Scene scene = with_lamp(with_cube(empty_scene(), {0, 0, 0}, 2, Normals::inward), {0, 0, 0.5});
  scene = with_cube(std::move(scene), {5, 0, 0}, 2, Normals::inward);
  scene = with_cube(std::move(scene), {5, 0, 0}, 1, Normals::outward);
  return with_polygon(std::move(scene), {{4, -0.9, -0.9}, {4.3, -0.9, -0.9}, {4.3, -0.7, -0.9}, {4, -0.7, -0.9}});
}

TEST(KeptSides, WhatStandsInADarkRoomIsLeftOutWithIt) {
  const KeptSides kept = automatic(lit_and_dark_room());
  expect_all(kept, 0, 6, front_only);
  expect_all(kept, 7, 20, no_side);
  // The second room's inner sides, both sides of the box's faces and both sides of the sheet.
  EXPECT_EQ(kept.unreached, 6U + 12U + 2U);
  // The outer sides of both rooms.
  EXPECT_EQ(kept.turned_away, 6U + 6U);
  ASSERT_EQ(kept.dark_solids.size(), 2U);
  EXPECT_EQ(kept.dark_solids[0].name, "'all' (room.obj:8)");
  EXPECT_EQ(kept.dark_solids[0].polygons, 6U);
}

TEST(KeptSides, SidesInTheDarkAreKeptWhenAskedFor) {
  const Scene scene = lit_and_dark_room();
  const KeptSides unreached = kept_sides(scene, Sides::automatic, {.unreached = true});
  expect_all(unreached, 0, 6, front_only);
  expect_all(unreached, 7, 13, front_only);
  expect_all(unreached, 13, 20, both_sides);
  EXPECT_EQ(unreached.unreached, 20U) << "counted all the same";
  const KeptSides turned_away = kept_sides(scene, Sides::automatic, {.turned_away = true});
  expect_all(turned_away, 0, 6, both_sides);
  expect_all(turned_away, 7, 13, back_only);
  expect_all(turned_away, 13, 20, no_side);
}

// Beside the lit room: a sheet outdoors, one on the outside of a wall, a rug on the floor, and ground under the room
// that extends into it.
TEST(KeptSides, OutsideOfTheLitRoomItIsDark) {
  Scene scene = with_lamp(with_cube(empty_scene(), {0, 0, 0}, 2, Normals::inward), {0, 0, 0.5});
  scene = with_polygon(std::move(scene), {{3, 0, 0}, {4, 0, 0}, {4, 1, 0}});
  scene = with_polygon(std::move(scene), {{1, 0, 0}, {1, 0.5, 0}, {1, 0.5, 0.5}});
  scene = with_polygon(std::move(scene), {{0, 0, -1}, {0.5, 0, -1}, {0.5, 0.5, -1}});
  scene = with_polygon(std::move(scene), {{-5, -5, -0.5}, {5, -5, -0.5}, {5, 5, -0.5}, {-5, 5, -0.5}});
  const KeptSides kept = automatic(scene);
  EXPECT_EQ(sides_of(kept, 7), no_side);
  EXPECT_EQ(sides_of(kept, 8), back_only) << "its front looks outward";
  EXPECT_EQ(sides_of(kept, 9), front_only) << "its front looks up";
  EXPECT_EQ(sides_of(kept, 10), both_sides);
}

// A lamp outside lights a sheet that extends through the wall of the dark room.
TEST(KeptSides, WhatReachesOutOfADarkRoomStays) {
  Scene scene = lit_and_dark_room();
  scene = with_polygon(std::move(scene), {{4.5, 0.9, 0}, {4.9, 0.9, 0}, {4.9, 1.4, 0}, {4.5, 1.4, 0}});
  EXPECT_EQ(sides_of(automatic(scene), 20), no_side) << "all lamps are in the other room";
  EXPECT_EQ(sides_of(automatic(with_lamp(std::move(scene), {5, 5, 0})), 20), both_sides);
}

// A dark solid with the outline of an E, 3 m high. The corners and the middle of a floor lie within its arms. Between
// the arms a lamp shines on it.
TEST(KeptSides, WhatLiesWithinADarkSolidInPartsStays) {
  const std::vector<Point> outline = {{0, 0, 0}, {9, 0, 0}, {9, 6, 0}, {8, 6, 0}, {8, 1, 0}, {7, 1, 0},
                                      {7, 6, 0}, {2, 6, 0}, {2, 1, 0}, {1, 1, 0}, {1, 6, 0}, {0, 6, 0}};
  const Vector low(0, 0, -0.5), high(0, 0, 2.5);
  Scene scene = empty_scene();
  std::vector<Point> top, bottom;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& a = outline[k];
    const Point& b = outline[(k + 1) % outline.size()];
    scene = with_polygon(std::move(scene), {a + low, b + low, b + high, a + high});
    top.push_back(a + high);
    bottom.insert(bottom.begin(), a + low);
  }
  scene = with_polygon(with_polygon(std::move(scene), top), bottom);
  scene = with_polygon(std::move(scene), {{0.5, 3, 0}, {8.5, 3, 0}, {8.5, 5, 0}, {0.5, 5, 0}});
  scene = with_lamp(std::move(scene), {1.5, 4, 2});
  const KeptSides kept = automatic(scene);
  EXPECT_EQ(kept.dark_solids.size(), 1U);
  EXPECT_EQ(sides_of(kept, 14), both_sides);
}

// A lamp through the wall of a room lights both sides of it.
TEST(KeptSides, ALampThroughAWallLightsBothSides) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 2, Normals::inward);
  scene = with_polygon(std::move(scene), {{0.2, 0, 0}, {1.4, 0, 0}, {1.4, 0.1, 0}, {0.2, 0.1, 0}}, lamp);
  expect_all(automatic(among_others(std::move(scene))), 0, 6, both_sides);
}

TEST(KeptSides, WithoutALampNothingIsLeftOutButTheInsides) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 4, Normals::inward);
  scene = with_polygon(std::move(scene), {{1, 1, 0}, {1.5, 1, 0}, {1, 1, 1}});
  const KeptSides kept = automatic(scene);
  expect_all(kept, 0, 6, back_only);
  EXPECT_EQ(sides_of(kept, 6), both_sides);
}

// A concave lamp around a pillar, with its centroid outside of it. A point inside the lamp counts, not its centroid.
TEST(KeptSides, AConcaveLampIsLookedForWhereItIs) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 1, Normals::outward);
  // A U around the cube, in the plane z = 0.1, front down.
  scene = with_polygon(
      std::move(scene),
      {{-2, 2, 0.1}, {-1, 2, 0.1}, {-1, -1, 0.1}, {1, -1, 0.1}, {1, 2, 0.1}, {2, 2, 0.1}, {2, -2, 0.1}, {-2, -2, 0.1}},
      lamp);
  ASSERT_LT(front_normal(scene, 6).z(), 0.5);
  expect_all(automatic(among_others(std::move(scene))), 0, 6, front_only);
}

// The same sides are kept after the polygons are shuffled and the model is rotated and moved.
TEST(KeptSides, DoNotDependOnOrderOrPosition) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 4, Normals::outward);
  scene = with_cube(std::move(scene), {0, 0, -1}, 1, Normals::outward);
  scene = with_cube(std::move(scene), {1, 1, 1}, 0.3, Normals::inward);
  scene = with_lamp(std::move(scene), {0, 0, 1.5});
  const KeptSides expected = automatic(scene);

  std::vector<PolygonIndex> order(scene.polygons.size());
  std::iota(order.begin(), order.end(), PolygonIndex{0});
  std::mt19937 random(1);
  const Eigen::AngleAxisd rotation(1.1, Vector(0.3, 1, -2).normalized());
  for (int trial = 0; trial < 5; ++trial) {
    std::shuffle(order.begin(), order.end(), random);
    Scene other = scene;
    for (Point& vertex : other.vertices) vertex = rotation * vertex + Vector(100, -50, 20);
    for (std::size_t k = 0; k < order.size(); ++k) other.polygons[k] = scene.polygons[order[k]];
    const KeptSides kept = automatic(other);
    for (std::size_t k = 0; k < order.size(); ++k) {
      EXPECT_EQ(sides_of(kept, static_cast<PolygonIndex>(k)), sides_of(expected, order[k]));
    }
  }
}

// A slab of a thousandth of the room's size still has an inside and an outside.
TEST(KeptSides, AThinSlabNextToALampStaysOutside) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 4, Normals::inward);
  scene = with_cube(std::move(scene), {0, 0, 1}, 0.004, Normals::outward);
  scene = with_lamp(std::move(scene), {0, 0, 1.0 + 0.002 + 0.004}, 0.004);
  const KeptSides kept = automatic(scene);
  expect_all(kept, 0, 12, front_only);
}

// Nested rooms: the lamp is inside both shells, and no light leaves the inner one.
TEST(KeptSides, ALampInTheInnermostShellIsHeldByAll) {
  Scene scene = with_cube(empty_scene(), {0, 0, 0}, 2, Normals::inward);
  scene = with_cube(std::move(scene), {0, 0, 0}, 3, Normals::outward);
  scene = with_lamp(std::move(scene), {0, 0, 0});
  const KeptSides kept = automatic(scene);
  expect_all(kept, 0, 6, front_only);
  expect_all(kept, 6, 12, no_side);
  EXPECT_EQ(kept.turned_away, 6U + 12U);
}

}  // namespace
}  // namespace patchlight::sides_test
