#include "gather/sensor_places.h"

#include "patchlight/gather/gather.h"

#include "mesh/mesher.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::sensor_places_test {
namespace {

using namespace test;

Eigen::Affine3d turned(double degrees, double scale) {
  return Eigen::Scaling(scale) * Eigen::Translation3d(0.3, -7, 2) *
         Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vector(1, 2, -0.5).normalized());
}

Point between(const Quad& quad, double u, double v) {
  return (1 - u) * ((1 - v) * quad[0] + v * quad[3]) + u * ((1 - v) * quad[1] + v * quad[2]);
}

Field gathered(const Scene& scene, const PatchMesh& mesh, const Field& radiosity) {
  const Occluder occluder(scene, Occluder::Blockers::all);
  std::vector<Sensor> sensors;
  for (const SensorPlace& place : place_sensors(scene, scene.sensors, kept_sides(scene, Sides::both), occluder)) {
    EXPECT_EQ(place.standing, Standing::free);
    sensors.push_back(place.sensor);
  }
  return gather_irradiance(mesh, radiosity, occluder, sensors).irradiance;
}

// A desk of radiosity 100 on both sides stands in a room whose walls have radiosity 1. A flat sheet does not see
// itself: sensors on it that face along it read 1, on either side of the rounded plane. The coordinates are rounded to
// a millionth of the desk, like those in files.
TEST(PlaceSensors, OnATurnedSheetDoNotSeeIt) {
  for (const double scale : {1.0, 1e-3, 25.4e-3}) {
    for (const double degrees : {0.0, 7.0, 20.0, 33.0, 45.0, 71.0}) {
      const Quad desk{Point(1, 1, 0.7), Point(2.6, 1, 0.7), Point(2.6, 1.8, 0.9), Point(1, 1.8, 0.9)};
      const Eigen::Affine3d motion = turned(degrees, scale);
      Scene scene = with_box(empty_scene({grey(0), grey(0)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
      scene = moved(with_quad(std::move(scene), desk, 1), motion);
      SensorGroup group{.name = "desk", .sensors = {}};
      for (const double u : {0.1, 0.35, 0.5, 0.77}) {
        for (const double v : {0.2, 0.5, 0.9}) {
          Point point = motion * between(desk, u, v);
          if (u > 0.4) point = (1e6 / scale * point).array().round() * 1e-6 * scale;
          const Vector normal = front_normal(scene, 6);
          group.sensors.push_back({point, v < 0.4 ? Vector(-normal) : normal});
        }
      }
      scene.sensors = {group};
      const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::both), 0.5 * scale);
      Field radiosity = Field::Ones(mesh.size(), 1);
      for (PatchIndex i = 0; i < mesh.size(); ++i)
        if (mesh.material[i] == 1) radiosity(i, 0) = 100;
      const Field irradiance = gathered(scene, mesh, radiosity);
      EXPECT_LT((irradiance - 1).abs().maxCoeff(), 1e-6) << degrees << " degrees, scale " << scale;
    }
  }
}

// A sensor on a sheet, at an angle a to it, receives light only from the side of the sheet that it faces. It sees that
// side: (1 - cos a) / 2 of its reading comes from the sheet, which is large enough to count as a plane.
TEST(PlaceSensors, AskewOnASheetSeeTheSideTheyFace) {
  Scene scene = with_box(empty_scene({grey(0), grey(0)}), Point(-5, -5, -5), Point(5, 5, 5), true);
  scene = with_quad(std::move(scene), {Point(-5, -5, 0), Point(5, -5, 0), Point(5, 5, 0), Point(-5, 5, 0)}, 1);
  const double angle = std::numbers::pi / 3;
  scene.sensors = {{.name = "askew", .sensors = {{Point(0, 0, -1e-12), {std::sin(angle), 0, std::cos(angle)}}}}};
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::both), 2.5);
  Field radiosity(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const bool sheet = mesh.material[i] == 1;
    radiosity(i, 0) = sheet ? (mesh.side[i] == Side::front ? 3 : 1000) : (mesh.centroid[i].z() > 0 ? 1 : 1000);
  }
  const double of_sheet = (1 - std::cos(angle)) / 2;
  // 1e-4 m above the sheet, 1e-5 of its size, the horizon is lower by 1e-4 / 5.
  EXPECT_NEAR(gathered(scene, mesh, radiosity)(0, 0), (1 - of_sheet) + 3 * of_sheet, 1e-4);
}

// A room of 6 x 3 x 2.5 m with a wall across it, 0.2 m thick, from x = 3. The wall has two faces with a door between
// them, its jambs and its lintel. Faces that would touch floor, ceiling or side walls are missing, so the wall is not a
// closed solid.
Scene divided_room(double lamp) {
  Scene scene = with_box(empty_scene({grey(0.5), grey(0, lamp)}), Point(0, 0, 0), Point(6, 3, 2.5), true);
  const auto outline = [](double x) {
    return std::vector<Point>{{x, 0, 0}, {x, 1, 0}, {x, 1, 2},   {x, 2, 2},
                              {x, 2, 0}, {x, 3, 0}, {x, 3, 2.5}, {x, 0, 2.5}};
  };
  const std::vector<Point> left = outline(3);
  const std::vector<Point> right = outline(3.2);
  scene = with_polygon(std::move(scene), {left.rbegin(), left.rend()});
  scene = with_polygon(std::move(scene), right);
  for (const std::size_t k : {1U, 2U, 3U})
    scene = with_quad(std::move(scene), {left[k], left[k + 1], right[k + 1], right[k]});
  return with_quad(std::move(scene), {Point(1, 1, 2.49), Point(1, 2, 2.49), Point(2, 2, 2.49), Point(2, 1, 2.49)}, 1);
}

TEST(PlaceSensors, InsideAWallThatStandsOpenOnTheFloorAreFound) {
  for (const Eigen::Affine3d& motion : {Eigen::Affine3d::Identity(), turned(33, 1), turned(20, 1e-3)}) {
    for (const Sides sides : {Sides::automatic, Sides::front, Sides::both}) {
      Scene scene = moved(divided_room(10), motion);
      SensorGroup group{.name = "plane", .sensors = {}};
      for (double x = 0.1; x < 6; x += 0.1) {
        for (const double y : {0.5, 1.5, 2.9})
          group.sensors.push_back({motion * Point(x + 0.003, y, 0.8), motion.linear().col(2).normalized()});
      }
      scene.sensors = {group};
      const Occluder occluder(scene, Occluder::Blockers::all);
      const auto places = place_sensors(scene, scene.sensors, kept_sides(scene, sides), occluder);
      for (std::size_t k = 0; k < places.size(); ++k) {
        const Point point = motion.inverse() * group.sensors[k].point;
        const bool in_wall = point.x() > 3 && point.x() < 3.2 && std::abs(point.y() - 1.5) > 0.5;
        EXPECT_EQ(places[k].standing == Standing::inside_wall, in_wall) << point.transpose() << ' ' << name_of(sides);
      }
    }
  }
}

// A room whose fronts face outward, with a floor of its own, stands on that floor like a wall. Light makes the
// difference: from a lamp in it or through a hole.
TEST(PlaceSensors, InALitRoomThatIsTurnedInsideOutAreFree) {
  for (const bool with_hole : {false, true}) {
    Scene scene = empty_scene({grey(0.5), grey(0, 1)});
    const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), false);
    for (std::size_t k = with_hole ? 2 : 1; k < faces.size(); ++k) scene = with_quad(std::move(scene), faces[k]);
    scene = with_quad(std::move(scene), {Point(-9, -9, 0), Point(9, -9, 0), Point(9, 9, 0), Point(-9, 9, 0)});
    if (with_hole) {
      // A ceiling with a hole of 1 cm.
      scene = with_polygon(std::move(scene), {{0, 0, 2.5},
                                              {4, 0, 2.5},
                                              {4, 3, 2.5},
                                              {0, 3, 2.5},
                                              {0, 0, 2.5},
                                              {1, 1, 2.5},
                                              {1, 1.01, 2.5},
                                              {1.01, 1.01, 2.5},
                                              {1.01, 1, 2.5},
                                              {1, 1, 2.5}});
    }
    const double height = with_hole ? 9 : 2;
    scene = with_quad(std::move(scene),
                      {Point(2, 1, height), Point(2, 2, height), Point(3, 2, height), Point(3, 1, height)}, 1);
    scene.sensors = {
        {.name = "room", .sensors = {{Point(1, 1, 0.8), Vector::UnitZ()}, {Point(3, 2, 1), Vector::UnitZ()}}}};
    const Occluder occluder(scene, Occluder::Blockers::all);
    for (const SensorPlace& place : place_sensors(scene, scene.sensors, kept_sides(scene, Sides::automatic), occluder))
      EXPECT_EQ(place.standing, Standing::free) << with_hole;
  }
}

}  // namespace
}  // namespace patchlight::sensor_places_test
