#include "patchlight/views/picture.h"

#include "page/drawn_faces.h"
#include "render/tone_map.h"
#include "tiny_simulation.h"

#include <gtest/gtest.h>
#include <string>

namespace patchlight::looks_test {
namespace {

// Its floor in a room, the others much brighter outside.
Simulation by_day() {
  Simulation simulation = tiny_simulation();
  simulation.enclosed = Eigen::Vector3d(1, 0, 0);
  return simulation;
}

double exposure_of_patches(const Simulation& simulation, const Eigen::Vector3d& which) {
  return exposure_for(display_radiance(simulation), simulation.problem.area.cwiseProduct(which),
                      bands_of(tiny_scene()));
}

TEST(ExposureOf, ByDayIsThatOfTheInside) {
  const Simulation whole = tiny_simulation(), day = by_day();
  EXPECT_EQ(exposure_of(whole), exposure_of_patches(whole, Eigen::Vector3d::Ones()));
  EXPECT_EQ(exposure_of(day), exposure_of_patches(day, day.enclosed));
  EXPECT_GT(exposure_of(day), 2 * exposure_of(whole));
}

// Without light there is no exposure to choose.
TEST(ExposureOf, IsThatOfAllWhereTheInsideIsDark) {
  Simulation day = by_day();
  day.solution.radiosity.row(0) = 0;
  EXPECT_EQ(exposure_of(day), exposure_of_patches(day, Eigen::Vector3d::Ones()));
}

TEST(LooksOf, ByDayAreForTheInsideAndForTheOutside) {
  const Simulation day = by_day();
  const SolvedSurface surface = surface_of(day);
  const double inside = exposure_of_patches(day, day.enclosed);
  const double outside = exposure_of_patches(day, Eigen::Vector3d(0, 1, 1));
  const std::vector<Look> from_inside = looks_of(surface, 1.5 * inside);
  ASSERT_EQ(from_inside.size(), 2U);
  EXPECT_EQ(from_inside[0].exposure, 1.5 * inside);
  EXPECT_EQ(from_inside[0].name, std::string("natural, exposed for the inside"));
  EXPECT_EQ(from_inside[1].exposure, outside);
  const std::vector<Look> from_outside = looks_of(surface, 0.9 * outside);
  ASSERT_EQ(from_outside.size(), 2U);
  EXPECT_EQ(from_outside[0].exposure, 0.9 * outside);
  EXPECT_EQ(from_outside[0].name, std::string("natural, exposed for the outside"));
  EXPECT_EQ(from_outside[1].exposure, inside);
}

TEST(LooksOf, AreOneWithoutDaylightOrWithoutAnInside) {
  const Simulation whole = tiny_simulation();
  EXPECT_EQ(looks_of(surface_of(whole), 3).size(), 1U);
  Simulation open = by_day();
  open.enclosed.setZero();
  EXPECT_EQ(looks_of(surface_of(open), 3).size(), 1U);
}

TEST(LooksPart, HasASkyWhereTheSceneHasOne) {
  Scene scene = tiny_scene();
  const Simulation day = by_day();
  EXPECT_FALSE(looks_part(surface_of(day), 1, 10)[0].contains("sky"));
  EXPECT_TRUE(sky_directions(surface_of(day)).is_null());
  scene.sky = Sky{.horizontal_irradiance = rgb(1, 1, 1)};
  const Simulation below_sky = in_scene(day, scene);
  for (const auto& look : looks_part(surface_of(below_sky), 1, 10)) EXPECT_EQ(look["sky"]["components"], 3);
  EXPECT_EQ(sky_directions(surface_of(below_sky))["directions"]["components"], 3);
}

}  // namespace
}  // namespace patchlight::looks_test
