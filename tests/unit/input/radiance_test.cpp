#include "patchlight/input/read_scene.h"

#include "model_files.h"

#include <cmath>
#include <map>
#include <numbers>

namespace patchlight::radiance_test {
namespace {

using std::numbers::pi;

const std::string materials = R"(# a comment
void plastic wall 0 0 5 .5 .25 .125 0 0
void plastic shiny
0
0
5 .5 .5 .5 .1 .05
void glass pane 0 0 3 .654 .654 .654
void trans sheet 0 0 7 .8 .8 .8 0 0 .5 .25
void trans blind 0 0 7 .8 .8 .8 0 0 .5 .75
void mirror polished 0 0 3 .9 .8 .7
void metal chrome 0 0 5 .8 .6 .4 .75 0
void metal brushed 0 0 5 .8 .6 .4 .75 .1
void light lamp 0 0 3 5 6 7
void glow ember 0 0 4 1 2 3 0
void spotlight beam 0 0 7 9 9 9 30 0 0 -1
wood texfunc grain 4 a b c d 0 0
void colorpict picture 7 red green blue wood.pic picture.cal u v 0 0
picture plastic papered 0 0 5 .4 .4 .4 0 0
void alias paint wall
)";
// Its front faces up.
const std::string triangle = "lamp polygon triangle 0 0 9  0 0 0  1 0 0  0 2 0\n";

std::string square(const std::string& material, double height) {
  const std::string z = std::to_string(height);
  return material + " polygon " + material + "_face 0 0 12 0 0 " + z + " 1 0 " + z + " 1 1 " + z + " 0 1 " + z + "\n";
}

class Radiance : public ModelFiles {
 protected:
  Radiance() {
    write("materials.mat", materials);
    write("part.rad", triangle);
  }
  Scene scene_with(const std::string& text, const ReadOptions& options = {}) const {
    const std::vector<std::filesystem::path> files = {folder_ / "materials.mat", write("scene.rad", text)};
    return read_scene(files, options);
  }
  Material material(const std::string& name) const {
    const Scene scene = scene_with(square("wall", 0) + square(name, 1));
    return scene.materials.at(scene.polygons.at(1).material);
  }
  std::string refusal_of(const std::string& text) const {
    try {
      scene_with(text);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << text;
    return {};
  }
};

Vector first_corner(const Scene& scene, PolygonIndex p) { return corner_points(scene, p)[0]; }

void expect_triangle(const Scene& scene, PolygonIndex p, const std::vector<Point>& expected) {
  std::vector<Point> found = corner_points(scene, p);
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT((found[k] - expected[k]).norm(), 1e-12) << k;
}

// Rotated x to y and y to -x, then scaled by two, then moved.
TEST_F(Radiance, StepsOfXformApplyInTheirOrder) {
  const Scene scene = scene_with("!xform -n moved -rz 90 -s 2 -t 10 0 0 \\\n part.rad\n");
  ASSERT_EQ(scene.polygons.size(), 1U);
  expect_triangle(scene, 0, {{10, 0, 0}, {10, 2, 0}, {6, 0, 0}});
  EXPECT_EQ(scene.groups.at(scene.polygons[0].group), "moved.triangle");
  EXPECT_EQ(scene.materials.at(scene.polygons[0].material).name, "lamp");
  EXPECT_TRUE(scene.up_stated);
  EXPECT_EQ(scene.up, Vector::UnitZ());
}

TEST_F(Radiance, AMirroredCopyKeepsItsFrontAndTakesTheMaterialOfTheOuterXform) {
  write("middle.rad", "!xform -m lamp part.rad\n");
  const Scene scene = scene_with("!xform -n mirrored -m wall -mx middle.rad\n!xform -I -t 0 0 1 part.rad\n");
  ASSERT_EQ(scene.polygons.size(), 2U);
  EXPECT_EQ(scene.materials.at(scene.polygons[0].material).name, "wall");
  EXPECT_GT(front_normal(scene, 0).z(), 0.999);
  EXPECT_LT(front_normal(scene, 1).z(), -0.999);
}

// Two rows of three at a height of 1 m, then half a turn made of two quarters.
TEST_F(Radiance, ArraysAndIterationsRepeatTheStepsBehindThem) {
  const Scene scene = scene_with("!xform -a 3 -t 1 0 0 -a 2 -t 0 10 0 -i 1 -t 0 0 1 part.rad\n" +
                                 std::string("!xform -i 2 -rz 90 -i 1 -t 0 0 5 part.rad\n"));
  ASSERT_EQ(scene.polygons.size(), 7U);
  std::map<std::pair<double, double>, int> places;
  for (PolygonIndex p = 0; p < 6; ++p) {
    EXPECT_EQ(first_corner(scene, p).z(), 1);
    ++places[{first_corner(scene, p).x(), first_corner(scene, p).y()}];
  }
  EXPECT_EQ(places.size(), 6U);
  EXPECT_EQ(places.begin()->first, std::pair(0.0, 0.0));
  EXPECT_EQ(places.rbegin()->first, std::pair(2.0, 10.0));
  expect_triangle(scene, 6, {{0, 0, 5}, {-1, 0, 5}, {0, -2, 5}});
}

TEST_F(Radiance, CopiesComeFromTheLinesOfAFileToo) {
  write("places.txt", "-t 0 0 1\n\n-t 0 0 2 -a 2 -t 0 0 7\n");
  const Scene scene = scene_with("!xform -rz 180 -f places.txt -t 1 0 0 part.rad\n");
  ASSERT_EQ(scene.polygons.size(), 3U);
  for (const auto& [p, z] : {std::pair(0U, 1.0), {1U, 2.0}, {2U, 9.0}})
    expect_triangle(scene, p, {{1, 0, z}, {0, 0, z}, {1, -2, z}});
}

TEST_F(Radiance, MaterialsAreWhatTheReferenceManualSays) {
  EXPECT_TRUE((material("paint").reflectance == rgb(.5, .25, .125)).all());
  EXPECT_NEAR(material("shiny").reflectance[0], .5 * .9 + .1, 1e-15);
  EXPECT_NEAR(material("sheet").reflectance[0], .4, 1e-15);
  EXPECT_NEAR(material("sheet").diffuse_transmittance[0], .8 * .5 * .75, 1e-15);
  EXPECT_NEAR(material("blind").transmittance[0], .8 * .5 * .75, 1e-15);
  EXPECT_TRUE((material("polished").specular_reflectance == rgb(.9, .8, .7)).all());
  EXPECT_TRUE(material("chrome").specular_reflectance.isApprox(rgb(.6, .45, .3)));
  EXPECT_TRUE(material("chrome").reflectance.isApprox(rgb(.2, .15, .1)));
  EXPECT_TRUE((material("brushed").reflectance == rgb(.8, .6, .4)).all());
  EXPECT_TRUE(material("lamp").exitance.isApprox(pi * rgb(5, 6, 7)));
  EXPECT_TRUE(material("ember").exitance.isApprox(pi * rgb(1, 2, 3)));
  EXPECT_TRUE((material("beam").exitance == 0).all());
}

// The manual gives the transmissivity for a transmittance T and the index 1.52: (sqrt(0.8402528435 + 0.0072522239 T^2)
// - 0.9166530661) / 0.0036261119 / T. Its ten digits are divided by a difference of about 0.005 T, which leaves 1e-7.
TEST_F(Radiance, TransmissivityOfGlassIsThatOfTheReferenceManual) {
  for (const double stated : {.05, .6, .88}) {
    const double transmissivity =
        (std::sqrt(.8402528435 + .0072522239 * stated * stated) - .9166530661) / .0036261119 / stated;
    const std::string t = std::to_string(transmissivity);
    const Scene scene = scene_with("void glass clear 0 0 3 " + t + " " + t + " " + t + "\n" + square("clear", 0));
    EXPECT_NEAR(scene.materials.at(0).transmittance[0], stated, 2e-6);  // six digits are written
    EXPECT_EQ(scene.materials.at(0).index, 1.52);
  }
  const Scene clear = scene_with("void glass clear 0 0 4 1 1 1 1.7\n" + square("clear", 0));
  EXPECT_NEAR(clear.materials.at(0).transmittance[0], 2 * 1.7 / (1.7 * 1.7 + 1), 1e-15);
}

// Sum of p . A / 3 over faces: the volume, above 0 with fronts outward.
struct Measured {
  double area = 0;
  double volume = 0;
};

Measured measured(const Scene& scene) {
  Measured sum;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> corners = corner_points(scene, p);
    sum.area += area_vector(corners).norm();
    sum.volume += corners[0].dot(area_vector(corners)) / 3;
  }
  return sum;
}

TEST_F(Radiance, RoundSurfacesKeepTheirAreas) {
  const auto read = [&](const std::string& text) { return measured(scene_with("wall " + text + "\n")); };
  constexpr double digits = 1e-10;
  EXPECT_NEAR(read("sphere a 0 0 4 1 2 3 .5").area, pi, digits);
  EXPECT_GT(read("sphere a 0 0 4 1 2 3 .5").volume, 0);
  EXPECT_LT(read("bubble a 0 0 4 1 2 3 .5").volume, 0);
  EXPECT_NEAR(read("cylinder a 0 0 7 0 0 0 0 3 4 .5").area, 5 * pi, digits);
  EXPECT_GT(read("cylinder a 0 0 7 0 0 0 0 3 4 .5").volume, 0);
  EXPECT_LT(read("tube a 0 0 7 0 0 0 0 3 4 .5").volume, 0);
  // Slant heights 5, of 3 and a difference of radii of 4.
  EXPECT_NEAR(read("cone a 0 0 8 0 0 0 0 0 3 5 1").area, pi * 6 * 5, digits);
  EXPECT_NEAR(read("cone a 0 0 8 0 0 0 0 0 3 0 4").area, pi * 4 * 5, digits);
  EXPECT_LT(read("cup a 0 0 8 0 0 0 0 0 3 5 1").volume, 0);
  EXPECT_NEAR(read("ring a 0 0 8 0 0 1 0 0 -1 3 2").area, 5 * pi, digits);
  EXPECT_NEAR(read("ring a 0 0 8 0 0 1 0 0 -1 0 2").area, 4 * pi, digits);
  EXPECT_LT(front_normal(scene_with("wall ring a 0 0 8 0 0 1 0 0 -1 0 2\n"), 0).z(), -0.999);
}

// A wall of 4 x 3 m with a window of 1 x 1 m, joined by a seam that the outline passes twice.
TEST_F(Radiance, HolesAreJoinedBySeams) {
  const Scene scene =
      scene_with("wall polygon w 0 0 30 0 0 0 4 0 0 4 0 3 0 0 3 0 0 0  1 0 1 1 0 2 2 0 2 2 0 1 1 0 1\n");
  ASSERT_EQ(scene.polygons.size(), 1U);
  EXPECT_NEAR(area_vector(corner_points(scene, 0)).norm(), 11, 1e-12);
}

// E = L pi sin^2(a / 2) for 0.533 degrees, the diameter of the sun in Radiance.
TEST_F(Radiance, ASmallSourceIsTheSun) {
  const std::string sun = "void light solar 0 0 3 1e6 2e6 3e6\nsolar source sun 0 0 4 0 3 4 .533\n";
  const Scene scene = scene_with(sun + square("wall", 0));
  ASSERT_TRUE(scene.sun);
  EXPECT_TRUE(scene.sun->direction.isApprox(Vector(0, .6, .8)));
  EXPECT_NEAR(scene.sun->normal_irradiance[0] / (1e6 * pi * std::pow(std::sin(.2665 * pi / 180), 2)), 1, 1e-12);
  EXPECT_FALSE(scene.sky);
}

TEST_F(Radiance, EvenHalfSpheresAreSkyAndGroundAndOthersAreNamed) {
  const std::string even =
      "void glow sky 0 0 4 2 2 2 0\nsky source up 0 0 4 0 0 1 180\n"
      "void glow earth 0 0 4 1 1 1 0\nearth source down 0 0 4 0 0 -1 180\n";
  const Scene scene = scene_with(even + square("wall", 0));
  ASSERT_TRUE(scene.sky);
  EXPECT_EQ(scene.sky->zenith_radiance[0], 2);
  EXPECT_EQ(scene.sky->ground_radiance[0], 1);
  const std::string varies =
      "void brightfunc skyfunc 2 skybr skybright.cal 0 7 1 2 3 4 0 0 1\nskyfunc glow sky 0 0 4 1 1 1 0\n"
      "sky source up 0 0 4 0 0 1 180\n";
  const Scene cloudy = scene_with(varies + square("wall", 0));
  EXPECT_FALSE(cloudy.sky);
  EXPECT_EQ(number_of(cloudy, DiagnosticCode::left_out), 1U);
  ReadOptions with_sky;
  with_sky.daylight.sky = SkyKind::cie_overcast;
  EXPECT_TRUE(scene_with(varies + square("wall", 0), with_sky).sky);
}

// The program that writes the pattern is not executed: the sky varies in an unknown way.
TEST_F(Radiance, ASourceBelowAnUndefinedModifierIsNoEvenSky) {
  const Scene scene = scene_with("!gensky 6 21 12\nskyfunc glow sky 0 0 4 1 1 1 0\nsky source up 0 0 4 0 0 1 180\n" +
                                 square("wall", 0));
  EXPECT_FALSE(scene.sky);
  EXPECT_EQ(number_of(scene, DiagnosticCode::left_out), 2U) << "the program and the source";
}

// As ies2rad writes it. The numbers of the light are a factor of the distribution, not its radiance.
TEST_F(Radiance, ALightBelowAPatternEmitsNothing) {
  const Scene scene = scene_with(
      "void brightdata office_dist 4 flatcorr office.dat source.cal src_theta 0 1 0.5\n"
      "office_dist light office_light 0 0 3 40 40 40\n" +
      square("office_light", 0) + square("wall", 1));
  EXPECT_TRUE((scene.materials[scene.polygons[0].material].exitance == 0).all());
  EXPECT_EQ(number_of(scene, DiagnosticCode::left_out), 1U);
}

// An alias inherits the modifier of its original, and a texture leaves the flux as it is.
TEST_F(Radiance, AnAliasAndATextureKeepTheEmission) {
  const Scene scene = scene_with(
      "void light bright 0 0 3 2 2 2\ninherit alias same bright\n"
      "void texfunc waves 4 wx wy wz waves.cal 0 1 1\nwaves light wavy 0 0 3 2 2 2\n" +
      square("same", 0) + square("wavy", 1));
  for (const Polygon& polygon : scene.polygons)
    EXPECT_NEAR(scene.materials[polygon.material].exitance[0], 2 * pi, 1e-12);
  EXPECT_EQ(number_of(scene, DiagnosticCode::left_out), 0U);
}

TEST_F(Radiance, WhatIsLeftOutIsNamed) {
  const Scene scene =
      scene_with(square("shiny", 0) + square("papered", 1) + square("void", 2) + square("beam", 3) +
                 "void mist fog 0 0 0\n" + square("fog", 4) + "void BRTDfunc odd 0 0 0\n" + square("odd", 5) +
                 "void instance chair 1 chair.oct 0 0\nvoid mesh cup 1 cup.rtm 0 0\n" + "!touch " +
                 (folder_ / "touched").string() + "\n!xform part.rad > copy.rad\n");
  EXPECT_EQ(scene.polygons.size(), 4U);
  for (const char* const part : {"1 (shiny)", "1 (papered)", "1 (void_face)", "1 (fog)", "1 (odd (BRTDfunc))"}) {
    EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {part})) << part;
  }
  EXPECT_EQ(number_of(scene, DiagnosticCode::left_out), 5U) << "an instance, a mesh, a spotlight and two programs";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "touched"));
}

// A box is closed: its area vectors add up to zero, and its volume follows from the divergence theorem.
struct BoxFacts {
  double area = 0;
  double volume = 0;
  Vector sum = Vector::Zero();
};

BoxFacts facts_of(const Scene& scene) {
  BoxFacts facts;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> corners = corner_points(scene, p);
    const Vector area = area_vector(corners);
    facts.area += area.norm();
    facts.sum += area;
    facts.volume += corners[0].dot(area) / 3;
  }
  return facts;
}

TEST_F(Radiance, GenboxMakesAClosedBox) {
  for (const bool is_inward : {false, true}) {
    const std::string option = is_inward ? " -i" : "";
    const Scene scene = scene_with("!genbox wall crate 1 2 3" + option + "\n");
    EXPECT_EQ(scene.polygons.size(), 6U);
    EXPECT_EQ(scene.groups.at(scene.polygons.at(0).group), "crate");
    const BoxFacts box = facts_of(scene);
    EXPECT_NEAR(box.area, 22, 1e-12);
    EXPECT_NEAR(box.volume, is_inward ? -6 : 6, 1e-12);
    EXPECT_LT(box.sum.norm(), 1e-12);
    EXPECT_LT((bounds(scene).max() - Point(1, 2, 3)).norm(), 1e-12);
    EXPECT_LT(bounds(scene).min().norm(), 1e-12);
  }
}

// A bevel b removes a prism of b^2 l / 2 from each edge with length l between its corners. From each corner it removes
// a cube without the remaining tetrahedron: 5/6 b^3.
TEST_F(Radiance, GenboxBevelsEdges) {
  const double b = 0.1;
  const Scene scene = scene_with("!genbox wall crate 1 2 3 -b 0.1\n");
  EXPECT_EQ(scene.polygons.size(), 26U);
  const BoxFacts box = facts_of(scene);
  const double edges = 4 * (0.8 + 1.8 + 2.8);
  EXPECT_NEAR(box.volume, 6 - b * b / 2 * edges - 8 * b * b * b * 5 / 6, 1e-12);
  const double sides = 2 * (0.8 * 1.8 + 1.8 * 2.8 + 0.8 * 2.8);
  EXPECT_NEAR(box.area, sides + std::sqrt(2.0) * b * edges + 8 * std::sqrt(3.0) / 2 * b * b, 1e-12);
  EXPECT_LT(box.sum.norm(), 1e-12);
}

// Six sides, twelve cylinders and eight spheres, as in the output of genbox.
TEST_F(Radiance, GenboxRoundsEdges) {
  const Scene scene = scene_with("!genbox wall crate 1 2 3 -r 0.1\n");
  const double edges = 4 * (0.8 + 1.8 + 2.8);
  const double sides = 2 * (0.8 * 1.8 + 1.8 * 2.8 + 0.8 * 2.8);
  EXPECT_NEAR(facts_of(scene).area, sides + 0.2 * std::numbers::pi * edges + 8 * 0.04 * std::numbers::pi, 1e-9);
}

TEST_F(Radiance, XformMovesWhatAPipeBringsIt) {
  const Scene scene = scene_with("!genbox wall crate 1 2 3 | xform -n a -rz 90 -t 5 0 0 | xform -n b -a 3 -t 0 0 10\n");
  ASSERT_EQ(scene.polygons.size(), 18U);
  EXPECT_EQ(scene.groups.at(scene.polygons[0].group), "b.a.crate");
  EXPECT_NEAR(facts_of(scene).volume, 18, 1e-10);
  EXPECT_LT((bounds(scene).min() - Point(3, 0, 0)).norm(), 1e-12);
  EXPECT_LT((bounds(scene).max() - Point(5, 1, 23)).norm(), 1e-12);
  EXPECT_EQ(scene_with("!xform part.rad|xform -t 0 0 9\n").polygons.size(), 1U);
}

// The last definition of that name before the surface. The material lies below the patterns.
TEST_F(Radiance, ADefinitionHoldsFromWhereItStands) {
  const Scene scene = scene_with(square("wall", 0) + "void plastic wall 0 0 5 .1 .1 .1 0 0\n" + square("wall", 1) +
                                 "wall texfunc bumps 4 a b c d 0 0\n" + square("bumps", 2));
  ASSERT_EQ(scene.polygons.size(), 3U);
  const auto reflectance = [&](std::size_t p) { return scene.materials.at(scene.polygons[p].material).reflectance[0]; };
  EXPECT_EQ(reflectance(0), .5);
  EXPECT_EQ(reflectance(1), .1);
  EXPECT_EQ(reflectance(2), .1);
}

TEST_F(Radiance, AnInstanceMayBeASceneFile) {
  const Scene scene = scene_with("wall instance chair 5 part.rad -t 0 0 3 0 0\n");
  ASSERT_EQ(scene.polygons.size(), 1U);
  EXPECT_EQ(scene.groups.at(scene.polygons[0].group), "chair.triangle");
  EXPECT_EQ(first_corner(scene, 0).z(), 3);
}

TEST_F(Radiance, ASceneFilePlacesFilesThatShareMaterials) {
  const Scene scene = read_scene(write("room.toml",
                                       "[[model]]\nfile = \"materials.mat\"\n[[model]]\nfile = \"part.rad\"\nunit = "
                                       "\"ft\"\ntranslate = [0, 0, 1]\n"));
  expect_triangle(scene, 0, {{0, 0, 1}, {0.3048, 0, 1}, {0, 0.6096, 1}});
}

TEST_F(Radiance, WhatCannotBeReadIsRefusedWithItsLine) {
  write("ring.rad", "!xform ring.rad\n");
  const std::string deep = (folder_ / "scene.rad").string();
  for (const auto& [text, message] : std::map<std::string, std::string>{
           {"\nnone polygon p 0 0 9 0 0 0 1 0 0 0 1 0", ":2: the material none of polygon p is not defined"},
           {"wall polygon p 0 0 9 0 0 0 1 0 0\n0 x 0", ":2: found 'x' where a number of polygon p is expected"},
           {"wall polygon p 0 0 8 0 0 0 1 0 0 0 1", ":1: polygon p has 8 numbers"},
           {"wall polygon p 0 0 9 0 0 0 1", ":2: the file ends where a number is expected"},
           {"wall polygon p 0 0 -9 0 0 0 1", ":1: found '-9' where the number of its numbers"},
           {"void plastic q 0 0 3 1 1 1", ":1: plastic q has 3 numbers; expected 5"},
           {"void alias q nothing", ":1: alias q stands for nothing"},
           {"wall sphere s 0 0 4 0 0 0 0", ":1: sphere s has no area"},
           {"wall sphere s 0 0 4 0 0 0 -1", ":1: sphere s has a negative radius"},
           {"wall cylinder s 0 0 7 0 0 0 0 0 0 1", ":1: cylinder s has no area"},
           {"lamp source s 0 0 4 0 0 0 1", ":1: source s has no direction"},
           {"\n\n!xform -t 1 0 part.rad", ":3: xform: found 'part.rad' where -t has a number"},
           {"!xform -s 0 part.rad", ":1: xform: -s makes everything flat"},
           {"!xform -q part.rad", ":1: xform: the option -q is not known"},
           {"!xform -a 1000 -t 1 0 0 -a 1000 -t 0 1 0 part.rad", ":1: xform: makes more than 100,000 copies"},
           {"!xform -t 1 0 0", ":1: xform without a file"},
           {"!genbox wall crate 1 2", ":1: genbox: "},
           {"!genbox wall crate 1 0 3", ":1: genbox: "},
           {"!genbox wall crate 1 2 3 -b .5", ":1: genbox: "},
           {"!genbox wall crate 1 2 3 -q", ":1: genbox: "},
           {"!genbox wall crate 1 2 3 -r", ":1: genbox: "},
           {"!genbox wall crate 1 2 3 | xform part.rad", ":1: xform names "},
           {"!xform absent.rad", ":1: names the file absent.rad, which is neither"},
           {"!xform scene.rad", ":1: names " + deep + ", which names this file again"}}) {
    EXPECT_NE(refusal_of(text + "\n").find("scene.rad" + message), std::string::npos) << refusal_of(text + "\n");
  }
  EXPECT_NE(refusal_of("!xform ring.rad\n").find("ring.rad:1: names "), std::string::npos);
}

TEST_F(Radiance, FilesOutsideOfTheFolderAreNotRead) {
  std::filesystem::create_directories(folder_ / "in");
  std::ofstream(folder_ / "in" / "scene.rad") << "!xform ../part.rad\n";
  const std::string message = refusal(folder_ / "in" / "scene.rad", {.confine = folder_ / "in"});
  EXPECT_NE(message.find("scene.rad:1: "), std::string::npos) << message;
}

}  // namespace
}  // namespace patchlight::radiance_test
