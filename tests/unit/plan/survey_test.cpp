#include "plan/survey.h"

#include "patchlight/base/error.h"
#include "patchlight/plan/plan.h"

#include "scene/repair.h"
#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::survey_test {
namespace {

using namespace test;

bool has(const SceneReport& report, DiagnosticCode kind) {
  return std::any_of(report.diagnostics.begin(), report.diagnostics.end(),
                     [kind](const Diagnostic& problem) { return problem.code == kind; });
}

SceneReport survey_of(const Scene& scene) { return survey(repair(scene)); }

// 4 x 3 x 2.5 m: surface 2 (12 + 10 + 7.5) = 59; the floating box 1 x 0.8 x 0.7: 2 (0.8 + 0.7 + 0.56) = 4.12; lamp 1.
TEST(Survey, CountsAndMeasures) {
  const SceneReport report = survey_of(furnished_room(0.5));
  EXPECT_EQ(report.polygons, 13U);
  EXPECT_EQ(report.vertices, 20U);
  EXPECT_EQ(report.lamps, 1U);
  EXPECT_NEAR(report.area, 59 + 4.12 + 1, 1e-12);
  EXPECT_EQ(report.bounds.sizes(), Vector(4, 3, 2.5));
  ASSERT_EQ(report.materials.size(), 2U);
  EXPECT_NEAR(report.materials[0].area, 59 + 4.12, 1e-12);
  EXPECT_EQ(report.materials[0].faces, 12U);
  EXPECT_EQ(report.materials[0].flux[0], 0);
  EXPECT_NEAR(report.materials[1].flux[0], 10, 1e-12);
  EXPECT_EQ(report.shells, 3U);
  EXPECT_EQ(report.closed_shells, 2U);
  EXPECT_EQ(report.open_edges, 4U) << "the rim of the lamp";
  EXPECT_NEAR(report.open_edge_length, 4, 1e-12);
  EXPECT_TRUE(report.usable);
  EXPECT_TRUE(report.diagnostics.empty());
}

TEST(Survey, LeavesOutMaterialsThatNoFaceHasAndCountsBacks) {
  Scene scene = furnished_room(0.5);
  scene.materials.push_back(grey(0.1));
  scene.materials.push_back(grey(0.2, 7));
  scene.polygons[12].back_material = 3;
  const SceneReport report = survey(scene);
  ASSERT_EQ(report.materials.size(), 3U);
  EXPECT_NEAR(report.materials[2].flux[0], 7, 1e-12);
}

TEST(Survey, GuessesTheUnitOfModelsOfImplausibleSize) {
  for (const auto& [scale, unit] : std::vector<std::pair<double, std::string>>{{1, ""}, {1000, "mm"}, {100, "cm"}}) {
    Scene scene = moved(furnished_room(0.5), Eigen::Affine3d(Eigen::UniformScaling<double>(scale)));
    const SceneReport report = survey_of(scene);
    EXPECT_EQ(report.unit_guess ? report.unit_guess->unit : "", unit);
    EXPECT_EQ(has(report, DiagnosticCode::implausible_size), !unit.empty());
  }
  // Read in millimeters, a model in meters is too small.
  Scene small = moved(furnished_room(0.5), Eigen::Affine3d(Eigen::UniformScaling<double>(1e-3)));
  small.metres_per_unit = 1e-3;
  EXPECT_EQ(survey_of(small).unit_guess.value().unit, "m");
  // No unit is that large.
  Scene tiny = moved(furnished_room(0.5), Eigen::Affine3d(Eigen::UniformScaling<double>(1e-3)));
  EXPECT_FALSE(survey_of(tiny).unit_guess);
  EXPECT_TRUE(has(survey_of(tiny), DiagnosticCode::implausible_size));
}

TEST(Survey, DoubtsNoUnitOfASiteWithBuildingsOfSomeHeight) {
  const auto on_lawn = [](double scale, double far) {
    const Scene room = moved(furnished_room(0.5), Eigen::Affine3d(Eigen::UniformScaling<double>(scale)));
    return with_polygon(room, {Point(-far, -far, 0), Point(far, -far, 0), Point(far, far, 0), Point(-far, far, 0)});
  };
  EXPECT_FALSE(has(survey_of(on_lawn(1, 80)), DiagnosticCode::implausible_size));
  EXPECT_FALSE(has(survey_of(on_lawn(20, 2000)), DiagnosticCode::implausible_size)) << "towers in a site of 4 km";
  EXPECT_TRUE(has(survey_of(on_lawn(100, 8000)), DiagnosticCode::implausible_size));
}

TEST(Survey, DoubtsNoUnitThatTheFileStates) {
  Scene tiny = moved(furnished_room(0.5), Eigen::Affine3d(Eigen::UniformScaling<double>(1e-3)));
  tiny.unit_stated = true;
  EXPECT_FALSE(has(survey_of(tiny), DiagnosticCode::implausible_size));
  EXPECT_FALSE(survey_of(tiny).unit_guess);
}

// The room is 5.6 m long, less than 30 m, and ends at x = 4 m.
TEST(Survey, LuminairesFarFromTheModelAreAWarning) {
  Scene scene = furnished_room(0.5);
  const auto lamp_at = [](double x) {
    return Luminaire{.name = "far", .place = "a.toml:7", .position = Point(x, 1, 1), .light = PointLight{}};
  };
  scene.luminaires = {lamp_at(33.9)};
  EXPECT_FALSE(has(survey_of(scene), DiagnosticCode::implausible_size)) << "as lamps on masts are";
  EXPECT_TRUE(problems_with_size(scene).empty());
  scene.luminaires.push_back(lamp_at(34.1));
  const SceneReport report = survey_of(scene);
  ASSERT_TRUE(has(report, DiagnosticCode::implausible_size));
  for (const char* words : {"1 luminaire ", "30.1 m", "5.59 m", "'far' of a.toml:7"})
    EXPECT_NE(report.diagnostics.front().text.find(words), std::string::npos) << report.diagnostics.front().text;
  scene.luminaires.push_back(lamp_at(304));
  ASSERT_EQ(problems_with_size(scene).size(), 1U) << "what solve and plan tell";
  EXPECT_EQ(problems_with_size(scene).front().count, 2U);
  EXPECT_NE(problems_with_size(scene).front().text.find(" 300 m"), std::string::npos);
}

// The room's ceiling lies at 3 m.
TEST(Survey, SpheresThatAFaceCutsAreAWarning) {
  Scene scene = furnished_room(0.5);
  const double ceiling = bounds(scene).max().z();
  const auto sphere_at = [&](double below, double radius) {
    return Luminaire{.name = "bulb",
                     .place = "a.toml:7",
                     .position = Point(2, 1.5, ceiling - below),
                     .light = SphericalLamp{radius, Spectrum::Ones(1)}};
  };
  scene.luminaires = {sphere_at(0.07, 0.06), sphere_at(0.1, 0.1)};
  EXPECT_TRUE(problems_with_size(scene).empty()) << "one hangs free, one touches the ceiling";
  scene.luminaires = {sphere_at(0.05, 0.06), sphere_at(-0.05, 0.06)};
  ASSERT_EQ(problems_with_size(scene).size(), 1U);
  EXPECT_EQ(problems_with_size(scene).front().count, 2U);
  EXPECT_EQ(problems_with_size(scene).front().text.rfind(
                "2 sphere luminaires are cut by faces (the first: 'bulb' (a.toml:7), of radius 0.06 m, whose middle is "
                "0.05 m from face '",
                0),
            0U)
      << problems_with_size(scene).front().text;
  scene.luminaires = {sphere_at(1.5, 4)};
  EXPECT_EQ(problems_with_size(scene).size(), 1U) << "one as large as the room";
}

TEST(Survey, FullReflectanceIsAWarning) {
  EXPECT_TRUE(has(survey_of(furnished_room(1)), DiagnosticCode::full_reflectance));
  EXPECT_FALSE(has(survey_of(furnished_room(0.99)), DiagnosticCode::full_reflectance));
}

TEST(Survey, WithoutALampItNamesWhatLooksLikeOne) {
  Scene scene = furnished_room(0.5, 0);
  scene.materials[0].name = "wall";
  scene.materials[1].name = "Ceiling Lamp";
  const SceneReport report = survey_of(scene);
  EXPECT_FALSE(report.usable);
  ASSERT_TRUE(has(report, DiagnosticCode::no_lamp));
  EXPECT_EQ(report.diagnostics[0].code, DiagnosticCode::no_lamp) << "the worst comes first";
  EXPECT_NE(report.diagnostics[0].text.find("read.settings 'Ceiling Lamp.radiance=10'"), std::string::npos)
      << report.diagnostics[0].text;

  scene.materials[1].name = "Ann's lamp";
  EXPECT_NE(first_light(scene).advice.find("read.settings 'Ann'\\''s lamp.radiance=10'"), std::string::npos)
      << "the line can be typed as it stands";

  scene.lamp_hints = {{"wall", rgb(20, 10, 5), "its Ka is 20, 10, 5"}};
  const std::string advice = first_light(scene).advice;
  EXPECT_NE(advice.find("its Ka is 20, 10, 5"), std::string::npos) << advice;
  EXPECT_NE(advice.find("read.settings wall.radiance=20,10,5"), std::string::npos) << advice;

  scene.lamp_hints.clear();
  scene.materials[1].name = "panel";
  EXPECT_NE(first_light(scene).advice.find("wall, panel"), std::string::npos);
  EXPECT_THROW(make_plan(scene, {}), InputError);
}

TEST(Survey, ProposesASkyOnlyWhereItGetsIn) {
  Scene closed = furnished_room(0.5, 0);
  closed.materials[0].name = "wall";
  closed.materials[1].name = "panel";
  const FirstLight luminaire = survey_of(closed).first_light.value();
  EXPECT_EQ(luminaire.setting, "") << "it takes a scene file";
  EXPECT_EQ(luminaire.advice.find("read.daylight.sky"), std::string::npos) << luminaire.advice;
  EXPECT_NE(luminaire.advice.find("\nhint: "), std::string::npos) << luminaire.advice;
  EXPECT_NE(luminaire.advice.find("patchlight init "), std::string::npos) << luminaire.advice;

  closed.materials[1].name = "lamp";
  EXPECT_EQ(first_light(closed).setting, "read.settings lamp.radiance=10");

  Scene open = closed;
  open.polygons.erase(open.polygons.begin());
  EXPECT_EQ(first_light(open).setting, "read.daylight.sky=overcast:10000lx");
  const Scene body = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(1, 1, 1), false);
  EXPECT_EQ(first_light(body).setting, "read.daylight.sky=overcast:10000lx");
  EXPECT_NE(first_light(body).advice.find("read.daylight.sky=overcast:10000lx"), std::string::npos)
      << first_light(body).advice;
  EXPECT_FALSE(survey_of(furnished_room(0.5)).first_light) << "it has a lamp";
}

}  // namespace
}  // namespace patchlight::survey_test
