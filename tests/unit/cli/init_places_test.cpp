#include "cli/init_places.h"

#include "input/toml/toml_sensors.h"
#include "support/scenes.h"

#include <gtest/gtest.h>
#include <utility>

// Sensors and views that `init` writes.
namespace patchlight::init_places_test {
namespace {

using namespace test;

NamedRoom room(const std::string& name, const Point& low, const Point& high) {
  NamedRoom air{name, {}, {}};
  for (const Quad& face : box_faces(low, high, true)) air.faces.emplace_back(face.begin(), face.end());
  return air;
}

// Living and Kitchen, 4 x 3 x 2.5 m each, under a sky. One wall of each is a pane: 3 m wide at the high x of Living, 4
// m at the low y of Kitchen.
Scene house() {
  Scene scene = empty_scene({grey(0.5), grey(0.1)});
  scene.materials[1].transmittance = Spectrum::Constant(1, 0.8);
  const Point size(4, 3, 2.5), kitchen(5, 0, 0);
  scene = with_box(std::move(scene), Point::Zero(), size, true);
  scene.polygons[3].material = 1;
  scene = with_box(std::move(scene), kitchen, kitchen + size, true);
  scene.polygons[6 + 2].material = 1;
  scene.rooms = {room("Living", Point::Zero(), size), room("Kitchen", kitchen, kitchen + size)};
  scene.sky = Sky{};
  return scene;
}

NewPlaces places_in(const Scene& scene) { return cli::new_places(scene).places; }

bool is_in(const Box& box, const Point& point) { return box.contains(point); }

TEST(NewPlaces, AreInAllRooms) {
  const Scene scene = house();
  const NewPlaces places = places_in(scene);
  ASSERT_TRUE(places.grid.has_value());
  EXPECT_EQ(places.grid->rooms, std::vector<std::string>{"*"});
  EXPECT_TRUE(places.rooms_without.empty());
  // 3 x 2 m remain without the strip, in cells of 0.2 * 5^log10(4) = 0.53 m at most.
  for (const SensorGroup& group : sensors_over(scene, *places.grid).groups) EXPECT_EQ(group.sensors.size(), 6U * 4);
}

// The view towards the larger window comes first, from eye height.
TEST(NewPlaces, HaveViewsTowardsWindows) {
  const std::vector<Camera> cameras = places_in(house()).cameras;
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].name, "Kitchen");
  EXPECT_TRUE(is_in(Box(Point(5.5, 0.5, 1.59), Point(8.5, 2.5, 1.61)), cameras[0].eye));
  EXPECT_LT(cameras[0].target.y(), cameras[0].eye.y());
  EXPECT_EQ(cameras[1].name, "Living");
  EXPECT_GT(cameras[1].target.x(), cameras[1].eye.x());
}

TEST(NewPlaces, AreNotOnARoof) {
  Scene scene = house();
  scene.rooms.push_back(room("Terrace", Point(0, 0, 2.5), Point(9, 3, 5)));
  const NewPlaces places = places_in(scene);
  ASSERT_TRUE(places.grid.has_value());
  EXPECT_EQ(places.grid->rooms, (std::vector<std::string>{"Living", "Kitchen"}));
  EXPECT_EQ(places.rooms_without, std::vector<std::string>{"Terrace"});
  for (const Camera& camera : places.cameras) EXPECT_NE(camera.name, "Terrace");
  scene.rooms.erase(scene.rooms.begin(), scene.rooms.begin() + 2);
  EXPECT_FALSE(places_in(scene).grid.has_value());
  EXPECT_TRUE(places_in(scene).cameras.empty());
}

// A slab of 11 x 5 m whose top is 0.3 m under the floor: it is the largest level face with air 0.8 m over it.
TEST(NewPlaces, AreOverTheFloorAndNotOverTheFooting) {
  Scene scene = house();
  scene.rooms.clear();
  scene.groups = {"walls", "floor", "footing"};
  scene.polygons[0].group = 1;
  const auto first = scene.polygons.size();
  scene = with_box(std::move(scene), Point(-1, -1, -0.8), Point(10, 4, -0.3), false);
  for (std::size_t p = first; p < scene.polygons.size(); ++p) scene.polygons[p].group = 2;
  ASSERT_EQ(named_floors(scene).front().name, "footing");
  const NewPlaces places = places_in(scene);
  ASSERT_TRUE(places.grid.has_value());
  EXPECT_NE(places.grid->group, "footing");
}

// A closed cupboard of 1 x 1 x 2.2 m stands in the middle of Living. No sensor and no eye is inside it, and no view
// ends at it.
TEST(NewPlaces, AreNotInSolids) {
  const Box cupboard(Point(1.5, 1, 0), Point(2.5, 2, 2.2));
  const Scene scene = with_box(house(), cupboard.min(), cupboard.max(), false);
  const NewPlaces places = places_in(scene);
  ASSERT_TRUE(places.grid.has_value());
  const std::vector<SensorGroup> groups = sensors_over(scene, *places.grid).groups;
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_LT(groups[0].sensors.size(), groups[1].sensors.size());
  for (const Sensor& sensor : groups[0].sensors) EXPECT_FALSE(is_in(cupboard, sensor.point));
  ASSERT_EQ(places.cameras.size(), 2U);
  for (int k = 0; k <= 100; ++k) {
    const Point on_way = places.cameras[1].eye + k / 100.0 * (places.cameras[1].target - places.cameras[1].eye);
    EXPECT_FALSE(is_in(cupboard, on_way));
  }
}

// A cupboard of 1 x 1 m covers a sixth of the 3 x 2 m without the strip.
TEST(NewPlaces, NoteTheShareOfAFloor) {
  const FloorGrid grid{"work plane", {}, {"Living"}, 0.8, 0.25, 0.5, {}, 0};
  EXPECT_TRUE(sensors_over(house(), grid).notes.empty());
  const Scene scene = with_box(house(), Point(1.5, 1, 0), Point(2.5, 2, 2.2), false);
  EXPECT_EQ(sensors_over(scene, grid).notes.size(), 1U);
}

}  // namespace
}  // namespace patchlight::init_places_test
