#include "plan/decide.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace patchlight::effect_facts_test {
namespace {

using namespace test;

EffectFacts facts_of(const Scene& scene, Sides sides = Sides::automatic) {
  return survey_effects(scene, kept_sides(scene, sides));
}

// A unit cube of one material whose faces look inward, and a lamp in it.
Scene coloured_room(const Spectrum& reflectance, const Spectrum& exitance) {
  const Spectrum none = Spectrum::Zero(3);
  Scene scene = empty_scene({{"wall", reflectance, none}, {"lamp", none, exitance}});
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(1, 1, 1), true);
  return with_quad(std::move(scene),
                   {Point(0.4, 0.4, 0.9), Point(0.4, 0.6, 0.9), Point(0.6, 0.6, 0.9), Point(0.6, 0.4, 0.9)}, 1);
}

TEST(SurveyEffects, CountsWhatCanStandBetween) {
  EXPECT_EQ(facts_of(cube_room(0.5, 1)).inside_hull, 0U);
  EXPECT_EQ(facts_of(furnished_room(0.5)).inside_hull, 7U) << "a box and a lamp";
}

TEST(SurveyEffects, OnlyMaterialsOfKeptSidesCount) {
  Scene scene = furnished_room(0);
  scene.materials.push_back(grey(0.9));
  EXPECT_EQ(facts_of(scene).highest_reflectance, 0) << "no face has it";
  scene.polygons[0].material = 2;
  EXPECT_EQ(facts_of(scene).highest_reflectance, 0.9);
}

TEST(SurveyEffects, GreySurfacesAndLightsOfOneColour) {
  const EffectFacts grey_facts = facts_of(coloured_room(rgb(0.5, 0.5, 0.5), rgb(10, 8, 5)));
  EXPECT_TRUE(grey_facts.grey);
  ASSERT_TRUE(grey_facts.lamp_colour);
  EXPECT_TRUE((*grey_facts.lamp_colour == rgb(1, 0.8, 0.5)).all());
  EXPECT_FALSE(facts_of(coloured_room(rgb(0.5, 0.5, 0.4), rgb(10, 8, 5))).grey);
}

TEST(SurveyEffects, ASecondLightOfAnotherColourIsSeen) {
  Scene scene = coloured_room(rgb(0.5, 0.5, 0.5), rgb(10, 8, 5));
  Luminaire luminaire;
  luminaire.position = {0.5, 0.5, 0.5};
  luminaire.light = PointLight{rgb(5, 4, 2.5)};
  scene.luminaires = {luminaire};
  EXPECT_TRUE(facts_of(scene).lamp_colour) << "half as bright, the same colour";
  scene.luminaires[0].light = PointLight{rgb(5, 4, 3)};
  EXPECT_FALSE(facts_of(scene).lamp_colour);
  scene.luminaires.clear();
  Sky sky;
  sky.horizontal_irradiance = rgb(1, 1, 1);
  scene.sky = sky;
  EXPECT_FALSE(facts_of(scene).lamp_colour);
}

TEST(SurveyEffects, BandsWithoutLight) {
  EXPECT_TRUE(facts_of(coloured_room(rgb(0.5, 0.5, 0.5), rgb(10, 8, 5))).dark_bands.empty());
  EXPECT_EQ(facts_of(coloured_room(rgb(0.5, 0.5, 0.5), rgb(10, 0, 5))).dark_bands, std::vector<Eigen::Index>{1});
}

TEST(SurveyEffects, DaylightNeedsAnOpeningOrASideThatSeesOut) {
  Scene scene = coloured_room(rgb(0.5, 0.5, 0.5), rgb(10, 8, 5));
  scene.sun = Sun{Vector::UnitZ(), rgb(1, 1, 1)};
  EXPECT_FALSE(facts_of(scene, Sides::front).sees_out) << "the lamp hangs in a closed room";
  EXPECT_TRUE(facts_of(scene).sees_out) << "the sun shines on its outer sides";
  Scene roofless = scene;
  roofless.polygons.erase(roofless.polygons.begin() + 1);
  EXPECT_TRUE(facts_of(roofless, Sides::front).sees_out);
  Material glass = scene.materials[0];
  glass.transmittance = rgb(0.4, 0.4, 0.4);
  scene.materials.push_back(glass);
  scene.polygons[1].material = 2;
  EXPECT_EQ(facts_of(scene, Sides::front).openings, 1U);
  EXPECT_TRUE(facts_of(scene, Sides::front).sees_out) << "through the opening";
  scene.materials[2].second_face = true;
  EXPECT_EQ(facts_of(scene, Sides::front).openings, 0U) << "counted with the first face of its pane";
}

// A pane with the index of air reflects nothing at any angle, by Fresnel's equations.
TEST(SurveyEffects, NothingReflectsWithTheIndexOfAir) {
  Scene scene = coloured_room(rgb(0.5, 0.5, 0.5), rgb(10, 8, 5));
  Material net = scene.materials[0];
  net.transmittance = rgb(0.4, 0.4, 0.4);
  scene.materials.push_back(net);
  scene.polygons[1].material = 2;
  EXPECT_EQ(facts_of(scene, Sides::front).reflecting, 1U);
  EXPECT_TRUE(has_reflections(facts_of(scene, Sides::front)));
  scene.materials[2].index = 1;
  EXPECT_EQ(facts_of(scene, Sides::front).openings, 1U);
  EXPECT_FALSE(has_reflections(facts_of(scene, Sides::front)));
}

TEST(SurveyEffects, CountsMaterialsThatAreNotSimulated) {
  Scene scene = cube_room(0.5, 1);
  scene.unsimulated = {
      {UnsimulatedProperty::mirror, 2}, {UnsimulatedProperty::glass, 1}, {UnsimulatedProperty::mirror, 3}};
  EXPECT_EQ(facts_of(scene).gloss, 5U);
  EXPECT_EQ(facts_of(scene).glass, 1U);
}

}  // namespace
}  // namespace patchlight::effect_facts_test
