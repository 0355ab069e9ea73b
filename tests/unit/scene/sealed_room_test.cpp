#include "scene/room_body.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace patchlight::sealed_room_test {
namespace {

using namespace test;

// A box of 4 x 3 x 2.5 m.
Scene box_of(const Material& material, bool inward) {
  return with_box(empty_scene({material}), Point(0, 0, 0), Point(4, 3, 2.5), inward);
}

// A closed house over an L of two arms, 1 m wide and 4 m long, 3 m high. In its nook x and y exceed 1.
Scene bent_house() {
  const std::vector<Point> outline = {Point(0, 0, 0), Point(4, 0, 0), Point(4, 1, 0),
                                      Point(1, 1, 0), Point(1, 4, 0), Point(0, 4, 0)};
  const Vector up(0, 0, 3);
  Scene scene = empty_scene({grey(0.5)});
  scene.up = Vector::UnitZ();
  scene = with_polygon(std::move(scene), outline);
  std::vector<Point> ceiling;
  for (auto corner = outline.rbegin(); corner != outline.rend(); ++corner) ceiling.emplace_back(*corner + up);
  scene = with_polygon(std::move(scene), ceiling);
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& a = outline[k];
    const Point& b = outline[(k + 1) % outline.size()];
    scene = with_polygon(std::move(scene), {b, a, a + up, b + up});
  }
  return scene;
}

bool is_sealed_room(const Scene& scene) {
  const std::optional<Solid> hull = sealed_hull(scene);
  return hull && is_room(scene, *hull);
}

TEST(SealedRoom, IsAClosedSolidAroundAllElse) {
  EXPECT_TRUE(is_sealed_room(box_of(grey(0.5), true)));
  EXPECT_TRUE(is_sealed_room(furnished_room(0.5, 0)));
  const Scene turned = with_box(box_of(grey(0.5), false), Point(1, 1, 0.5), Point(2, 2, 1), false);
  EXPECT_TRUE(is_sealed_room(turned)) << "what stands in it tells that it is one";
  EXPECT_EQ(sealed_hull(turned)->polygons.size(), 6U);
  Scene named = box_of(grey(0.5), false);
  named.rooms.emplace_back().name = "hall";
  EXPECT_TRUE(is_sealed_room(named));
}

TEST(SealedRoom, IsNoBodyInTheOpen) {
  EXPECT_FALSE(is_sealed_room(box_of(grey(0.5), false)));
  EXPECT_TRUE(sealed_hull(box_of(grey(0.5), false))) << "but no light gets into it";
  EXPECT_FALSE(sealed_hull(with_box(box_of(grey(0.5), true), Point(5, 0, 0), Point(6, 1, 1), false)));
}

// An object in the nook is outdoors. A picture on one of its walls is not, and neither is an object 100 km away.
TEST(SealedRoom, HoldsAllButWhatIsFar) {
  EXPECT_TRUE(is_sealed_room(with_box(bent_house(), Point(0.2, 0.2, 1), Point(0.8, 3.8, 2), false)));
  EXPECT_FALSE(sealed_hull(with_box(bent_house(), Point(2, 2, 0), Point(3, 3, 2), false)));
  const Quad picture = {Point(0, 2, 1), Point(0, 2, 2), Point(0, 3, 2), Point(0, 3, 1)};
  EXPECT_TRUE(is_sealed_room(with_quad(bent_house(), picture)));
  EXPECT_TRUE(sealed_hull(with_box(bent_house(), Point(1e5, 2, 0), Point(1e5 + 1, 3, 2), false)));
}

// For any number of objects inside, and for few outside.
TEST(SealedRoom, HoldsAllOfMany) {
  Scene scene = bent_house();
  for (int k = 0; k < 300; ++k)
    scene = with_box(std::move(scene), Point(0.1, 1 + 0.009 * k, 1), Point(0.9, 1.005 + 0.009 * k, 2), false);
  EXPECT_TRUE(sealed_hull(scene));
  EXPECT_FALSE(sealed_hull(with_box(std::move(scene), Point(2, 2, 0), Point(3, 3, 2), false)));
}

TEST(SealedRoom, LetsNoLightIn) {
  Scene without_a_wall = box_of(grey(0.5), true);
  without_a_wall.polygons.pop_back();
  EXPECT_FALSE(sealed_hull(without_a_wall));
  Scene with_a_window = box_of(grey(0.5), true);
  with_a_window.materials.push_back(grey(0));
  with_a_window.materials[1].transmittance = rgb(0.8, 0.8, 0.8);
  with_a_window.materials[1].index = 1.5;
  with_a_window.polygons[0].material = 1;
  EXPECT_FALSE(sealed_hull(with_a_window));
}

TEST(SealedRoom, HasALampUnderItsCeiling) {
  for (const bool inward : {true, false}) {
    const Scene room = with_box(box_of(grey(0.5), inward), Point(1, 1, 0.5), Point(2, 2, 1), false);
    EXPECT_TRUE(place_under_ceiling(room, *sealed_hull(room)).value().isApprox(Point(2, 1.5, 2.25), 1e-12));
  }
}

// The middle of its box, (2, 2), lies outside the L.
TEST(SealedRoom, OfAnyShapeHoldsItsLamp) {
  const Scene scene = bent_house();
  const std::optional<Solid> room = sealed_hull(scene);
  ASSERT_TRUE(room);
  const std::optional<Point> lamp = place_under_ceiling(scene, *room);
  ASSERT_TRUE(lamp);
  EXPECT_TRUE(holds(*room, *lamp)) << lamp->transpose();
  EXPECT_NEAR(lamp->z(), 2.7, 1e-12);
}

// The faces of a spire over a corner are too steep for a ceiling, and there is no room over the middle of its box.
TEST(SealedRoom, HasNoLampWhereNoneFits) {
  Scene scene = empty_scene({grey(0.5)});
  scene.up = Vector::UnitZ();
  const Point a(0, 0, 0), b(4, 0, 0), c(0, 4, 0), top(0, 0, 3);
  for (const std::vector<Point>& face : {std::vector{a, c, b}, {a, b, top}, {a, top, c}, {b, c, top}})
    scene = with_polygon(std::move(scene), face);
  const std::optional<Solid> room = sealed_hull(scene);
  ASSERT_TRUE(room);
  EXPECT_FALSE(place_under_ceiling(scene, *room));
}

}  // namespace
}  // namespace patchlight::sealed_room_test
