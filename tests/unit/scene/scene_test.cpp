#include "patchlight/scene/scene.h"

#include "patchlight/base/error.h"

#include "support/scenes.h"

#include <gtest/gtest.h>
#include <limits>
#include <string>

namespace patchlight::scene_test {
namespace {

using test::empty_scene, test::grey, test::Quad, test::with_box, test::with_quad;

Scene square_scene() {
  Scene scene;
  scene.file = "room.obj";
  scene.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {9, 9, 9}};
  scene.polygons = {{.corners = {0, 1, 2, 3}, .material = 0, .group = 0, .line = 12}};
  scene.materials = {{"wall", rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}};
  scene.groups = {"all"};
  return scene;
}

// The message of check() for a scene. Empty if it accepts the scene.
std::string refusal(const Scene& scene) {
  try {
    check(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

bool begins(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

TEST(Scene, TheFrontIsWhereCornersRunCounterClockwise) {
  Scene scene = square_scene();
  EXPECT_EQ(front_normal(scene, 0), Vector(0, 0, 1));
  std::swap(scene.polygons[0].corners[1], scene.polygons[0].corners[3]);
  EXPECT_EQ(front_normal(scene, 0), Vector(0, 0, -1));
  scene.polygons[0].corners = {0, 1, 1};
  EXPECT_EQ(front_normal(scene, 0), Vector(0, 0, 0));
}

TEST(Scene, BoundsCoverThePolygonsAlone) {
  const Box box = bounds(square_scene());
  EXPECT_EQ(box.min(), Point(0, 0, 0));
  EXPECT_EQ(box.max(), Point(2, 2, 0));
}

TEST(Scene, ALampEmitsInAnyBand) {
  Scene scene = square_scene();
  EXPECT_FALSE(is_lamp(scene, 0));
  scene.materials[0].exitance = rgb(0, 0, 1e-9);
  EXPECT_TRUE(is_lamp(scene, 0));
}

TEST(Scene, FloorsAndCeilingsTellWhichAxisIsUp) {
  // 6 x 4 x 2.5: floor and ceiling have 24, the next larger walls 15.
  EXPECT_EQ(upright_axis(with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(6, 4, 2.5), true)),
            Vector(Vector::UnitZ()));
  EXPECT_EQ(upright_axis(with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(6, 2.5, 4), true)),
            Vector(Vector::UnitY()));
}

TEST(Scene, InACubeTheLampTellsWhichAxisIsUp) {
  const Scene cube = with_box(empty_scene({grey(0.5), grey(0.5, 1)}), Point(0, 0, 0), Point(1, 1, 1), true);
  EXPECT_EQ(upright_axis(cube), Vector(Vector::UnitZ()));
  const Quad under_y = {Point(0.4, 0.9, 0.4), Point(0.6, 0.9, 0.4), Point(0.6, 0.9, 0.6), Point(0.4, 0.9, 0.6)};
  EXPECT_EQ(upright_axis(with_quad(cube, under_y, 1)), Vector(Vector::UnitY()));
}

// Exchange areas of smaller ones are below the smallest float.
TEST(CheckScene, RefusesModelsOfNoSize) {
  for (const auto& [metres, said] :
       std::vector<std::pair<double, std::string>>{{1e-12, ""},
                                                   {1e-13, "room.obj: the model is 2e-13 m long"},
                                                   {1e-43, "room.obj: the model is 2e-43 m long"}}) {
    Scene scene = square_scene();
    for (Point& vertex : scene.vertices) vertex *= metres;
    const std::string found = refusal(scene);
    EXPECT_TRUE(said.empty() ? found.empty() : begins(found, said)) << found;
  }
}

TEST(CheckScene, AcceptsReflectancesFromZeroToOne) {
  Scene scene = square_scene();
  for (const double rho : {0.0, 0.5, 1.0}) {
    scene.materials[0].reflectance = rgb(rho, rho, rho);
    EXPECT_EQ(refusal(scene), "");
  }
}

TEST(CheckScene, NamesTheMaterialThatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double rho : {-1e-9, 1 + 1e-9, nan, infinity}) {
    Scene scene = square_scene();
    scene.materials[0].reflectance[1] = rho;
    EXPECT_TRUE(begins(refusal(scene), "room.obj: material 'wall' ")) << rho;
  }
  for (const double exitance : {-1e-9, nan, infinity}) {
    Scene scene = square_scene();
    scene.materials[0].exitance[2] = exitance;
    EXPECT_TRUE(begins(refusal(scene), "room.obj: material 'wall' ")) << exitance;
  }
  for (const double index : {1 - 1e-9, -1.0, nan, infinity}) {
    Scene scene = square_scene();
    scene.materials[0].index = index;
    EXPECT_TRUE(begins(refusal(scene), "room.obj: material 'wall' ")) << index;
  }
}

TEST(CheckScene, WantsOneOfTheStatedBandsForEachValue) {
  Scene scene = square_scene();
  scene.bands = usual_bands(3);
  EXPECT_EQ(refusal(scene), "");
  scene.bands.pop_back();
  EXPECT_TRUE(begins(refusal(scene), "room.obj: "));
  EXPECT_NE(refusal(scene).find("2 bands"), std::string::npos);
}

TEST(CheckScene, NamesTheLineOfABadPolygon) {
  Scene scene = square_scene();
  scene.polygons[0].corners = {0, 1};
  EXPECT_TRUE(begins(refusal(scene), "room.obj:12: "));
  EXPECT_NE(refusal(scene).find("2 corners"), std::string::npos);
  scene.polygons[0].corners = {0, 1, 5};
  EXPECT_TRUE(begins(refusal(scene), "room.obj:12: "));
  EXPECT_NE(refusal(scene).find("vertex 6 of 5"), std::string::npos);
  scene.polygons[0].corners = {0, 1, 1};
  EXPECT_TRUE(begins(refusal(scene), "room.obj:12: "));
  EXPECT_NE(refusal(scene).find("no area"), std::string::npos);
  scene.polygons[0].corners = {0, 1, 2, 4};
  EXPECT_NE(refusal(scene).find("one plane"), std::string::npos);
  scene.polygons[0].line = 0;
  EXPECT_TRUE(begins(refusal(scene), "room.obj"));
  EXPECT_NE(refusal(scene).find(": the corners"), std::string::npos);
}

TEST(CheckScene, RefusesAnEmptySceneAndVerticesThatAreNotFinite) {
  Scene scene = square_scene();
  scene.vertices[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(begins(refusal(scene), "room.obj: "));
  scene = square_scene();
  scene.polygons.clear();
  EXPECT_TRUE(begins(refusal(scene), "room.obj: "));
}

// Planarity and area of a face are questions of shape, not of size.
TEST(CheckScene, DoesNotDependOnTheSizeOfTheModel) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Scene scene = square_scene();
    for (Point& vertex : scene.vertices) vertex *= scale;
    EXPECT_EQ(refusal(scene), "") << scale;
    scene.polygons[0].corners = {0, 1, 2, 4};
    EXPECT_NE(refusal(scene), "") << scale;
  }
}

}  // namespace
}  // namespace patchlight::scene_test
