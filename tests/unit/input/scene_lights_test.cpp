#include "patchlight/input/read_scene.h"

#include "light/photometry.h"
#include "light/solar_position.h"
#include "model_files.h"
#include "scene/photometric_web.h"

#include <numbers>
#include <variant>

namespace patchlight::scene_lights_test {
namespace {

using std::numbers::pi;

// A type C table of 100 cd in all directions below and above the horizon.
constexpr const char* ies =
    "IESNA:LM-63-2002\n[TEST] made up\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 60\n0 90 180\n0\n100 100 100\n";

class SceneLights : public ModelFiles {
 protected:
  SceneLights() {
    write("room.obj", "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nf 1 2 3 4\n");
    write("lamp.ies", ies);
  }
  Scene read(const std::string& toml) const { return read_scene(write("scene.toml", toml)); }
  void expect_refused(const std::string& toml, const std::vector<std::string>& parts) const {
    const std::string message = refusal(write("scene.toml", toml));
    for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
  }
};

const std::string room = "up = \"z\"\n[[model]]\nfile = \"room.obj\"\n";
const std::string lamp = room + "[[luminaire]]\nposition = [1, 2, 2.5]\n";  // its keys start at line 6

double lux_at_a_metre(const Spectrum& intensity) { return luminance(intensity); }

// Isotropic: I = Phi / 4 pi, so that 1000 lm give 79.577 lx at 1 m.
TEST_F(SceneLights, LumensOfAPointAreSpreadOverTheSphere) {
  const Scene scene = read("unit = \"cm\"\n" + lamp + "kind = \"point\"\nlumens = 1000\n");
  ASSERT_EQ(scene.luminaires.size(), 1U);
  const Luminaire& luminaire = scene.luminaires[0];
  EXPECT_EQ(luminaire.position, Point(0.01, 0.02, 0.025));
  EXPECT_EQ(luminaire.place, (folder_ / "scene.toml").string() + ":5");
  const Spectrum& intensity = std::get<PointLight>(luminaire.light).intensity;
  ASSERT_EQ(intensity.size(), 3);
  EXPECT_NEAR(lux_at_a_metre(intensity), 1000 / (4 * pi), 1e-12);
  EXPECT_TRUE(scene.photometric);
}

TEST_F(SceneLights, ColorsShareTheLumensAndWattsAreGivenPerBand) {
  const Scene colored = read(lamp + "kind = \"point\"\nlumens = 500\ncolor = [2, 1, 0]\n");
  const Spectrum& intensity = std::get<PointLight>(colored.luminaires[0].light).intensity;
  EXPECT_NEAR(lux_at_a_metre(intensity), 500 / (4 * pi), 1e-12);
  EXPECT_NEAR(intensity[0], 2 * intensity[1], 1e-15);
  EXPECT_EQ(intensity[2], 0);
  const Scene radiant = read(lamp + "kind = \"point\"\nwatts = [1, 2, 3]\n");
  EXPECT_NEAR(std::get<PointLight>(radiant.luminaires[0].light).intensity[2], 3 / (4 * pi), 1e-15);
  EXPECT_FALSE(radiant.photometric);
}

TEST_F(SceneLights, SpotsAndSpheresGiveTheFluxThatIsStated) {
  const Scene spot = read(lamp + "kind = \"spot\"\nlumens = 179\nbeam_angle = 30\nfield_angle = 60\naim = [0, 2, 0]\n");
  const SpotLight& light = std::get<SpotLight>(spot.luminaires[0].light);
  EXPECT_NEAR(light.intensity[0] * spot_solid_angle(light), 1, 1e-12);
  EXPECT_EQ(light.beam_half_angle, 15);
  EXPECT_EQ(light.field_half_angle, 30);
  EXPECT_EQ(spot.luminaires[0].aim, Vector(0, 1, 0));
  EXPECT_NEAR(spot.luminaires[0].aim.dot(spot.luminaires[0].zero_plane), 0, 1e-15);

  const Scene sphere = read(lamp + "kind = \"sphere\"\nwatts = 5\nradius = 0.1\n");
  const SphericalLamp& ball = std::get<SphericalLamp>(sphere.luminaires[0].light);
  EXPECT_NEAR(ball.exitance[1] * 4 * pi * 0.1 * 0.1, 5, 1e-14);  // E 4 pi r^2
}

// 100 cd in all directions are 1256.6 lm. A flux of 628.3 lm halves them.
TEST_F(SceneLights, PhotometricFilesAreReadAndScaled) {
  const std::string keys = room + "[[luminaire]]\nkind = \"ies\"\nfile = \"lamp.ies\"\npositions = [[0,0,2],[1,0,2]]\n";
  const Scene scene = read(keys);
  ASSERT_EQ(scene.luminaires.size(), 2U);
  EXPECT_EQ(scene.luminaires[1].position, Point(1, 0, 2));
  EXPECT_EQ(scene.luminaires[1].aim, Vector(0, 0, -1));
  EXPECT_EQ(scene.luminaires[1].zero_plane, Vector(1, 0, 0));
  const WebLight& whole = std::get<WebLight>(scene.luminaires[0].light);
  EXPECT_NEAR(luminance(whole.watts_per_lumen), 1, 1e-15);
  const Scene half = read(keys + "lumens = 628.3185\n");
  // The flux is integrated in steps of 0.5 degrees: 1e-5.
  EXPECT_NEAR(luminance(std::get<WebLight>(half.luminaires[0].light).watts_per_lumen), 0.5, 1e-5);
}

TEST_F(SceneLights, SkiesHaveTheHorizontalIlluminanceStated) {
  const Scene scene = read(room + "[sky]\nkind = \"overcast\"\nilluminance = 17900\n[ground]\nreflectance = 0.2\n");
  ASSERT_TRUE(scene.sky.has_value());
  EXPECT_EQ(scene.sky->kind, SkyKind::cie_overcast);
  EXPECT_NEAR(scene.sky->horizontal_irradiance[0], 100, 1e-12);
  EXPECT_NEAR(scene.sky->ground_radiance[0], 0.2 * 100 / pi, 1e-12);  // L = rho E / pi
  EXPECT_FALSE(scene.sun.has_value());
  EXPECT_TRUE(scene.photometric);
}

// Greenwich, equinox of March 2024, true noon (12:07:26 UTC by the equation of time, -7.4 minutes). The sun is in the
// south, 90 - 51.4769 degrees high, within 0.2 degrees, the declination on that day.
TEST_F(SceneLights, TheSunStandsWherePlaceAndTimeSay) {
  const std::string site = room + "[site]\nlatitude = 51.4769\nlongitude = 0\n[sun]\nirradiance = 800\ntime = ";
  const Scene scene = read(site + "2024-03-20T12:07:26Z\n");
  const double altitude = std::asin(scene.sun->direction.z()) * 180 / pi;
  EXPECT_NEAR(altitude, 90 - 51.4769, 0.2);
  EXPECT_LT(std::abs(scene.sun->direction.x()), 0.005);
  EXPECT_LT(scene.sun->direction.y(), 0);
  EXPECT_EQ(scene.sun->normal_irradiance.size(), 3);
  // The same instant in the local time of Paris, with north along x.
  const Scene paris = read("north = [1, 0, 0]\n" + site + "2024-03-20T13:07:26+01:00\n");
  EXPECT_LT(
      (paris.sun->direction - Vector(scene.sun->direction.y(), -scene.sun->direction.x(), scene.sun->direction.z()))
          .norm(),
      1e-12);
}

TEST_F(SceneLights, PerezSkiesBringTheirSun) {
  const Scene scene = read(room +
                           "[sun]\ndirection = [0, -1, 1]\n[sky]\nkind = \"perez\"\ndirect_normal = 700\n"
                           "diffuse_horizontal = 150\n");
  const Daylight expected = measured_daylight({.direct_normal = 700, .diffuse_horizontal = 150},
                                              Vector(0, -1, 1).normalized(), Vector::UnitZ(), 3);
  ASSERT_TRUE(scene.sun && scene.sky);
  EXPECT_TRUE((scene.sun->normal_irradiance == expected.sun->normal_irradiance).all());
  EXPECT_EQ(scene.sky->clearness, expected.sky->clearness);
}

TEST_F(SceneLights, DirectionsFollowTheUprightAxis) {
  const Scene scene = read(
      "up = \"y\"\n[[model]]\nfile = \"room.obj\"\n[[luminaire]]\nkind = \"ies\"\n"
      "file = \"lamp.ies\"\nposition = [0, 2, 0]\n");
  EXPECT_EQ(scene.luminaires[0].aim, Vector(0, -1, 0));
  EXPECT_EQ(scene.north, Vector(0, 0, -1));
}

TEST_F(SceneLights, WrongLightsAreRefusedWithLineAndKey) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {lamp + "kind = \"bulb\"\n", {"scene.toml:6: luminaire.kind: found 'bulb'", "'sphere'"}},
      {lamp + "kind = \"point\"\n", {"scene.toml:4: luminaire: found none of them", "lumens, watts"}},
      {lamp + "kind = \"point\"\nlumens = -1\n", {"scene.toml:7: luminaire.lumens: found -1"}},
      {lamp + "kind = \"point\"\nlumens = 1\nradius = 1\n", {"scene.toml:8: unknown key 'radius'"}},
      {lamp + "kind = \"point\"\nlumen = 1\n", {"scene.toml:7: ", "did you mean 'lumens'?"}},
      {lamp + "kind = \"point\"\nlumens = 1\ncolor = [0, 0, 0]\n", {"scene.toml:8: luminaire.color"}},
      {lamp + "kind = \"point\"\nwatts = 1\ncolor = [1, 1, 1]\n", {"scene.toml:8: luminaire.color"}},
      {lamp + "kind = \"spot\"\nlumens = 1\nbeam_angle = 60\nfield_angle = 30\n",
       {"scene.toml:9: luminaire.field_angle"}},
      {lamp + "kind = \"sphere\"\nlumens = 1\nradius = 0\n", {"scene.toml:8: luminaire.radius: found 0"}},
      {lamp + "kind = \"ies\"\nfile = \"no.ies\"\n", {"no.ies", "does not exist"}},
      {lamp + "kind = \"ies\"\nfile = \"lamp.ies\"\nzero_plane = [0, 0, 1]\n", {"scene.toml:4: ", "along the aim"}},
      {room + "[[luminaire]]\nkind = \"point\"\nlumens = 1\npositions = []\n", {"scene.toml:7: luminaire.positions"}},
      {room + "[sun]\nirradiance = 1\n", {"scene.toml:4: sun: found none of them", "direction, time"}},
      {room + "[sun]\ndirection = [0, 0, 1]\n", {"scene.toml:4: sun: found none of them", "irradiance, illuminance"}},
      {room + "[sun]\nirradiance = 1\ntime = 2024-06-21T12:00:00Z\n", {"scene.toml:6: ", "[site]"}},
      {room + "[site]\nlatitude = 1\nlongitude = 2\n[sun]\nirradiance = 1\ntime = 2024-06-21T12:00:00\n",
       {"scene.toml:9: sun.time: found 2024-06-21T12:00:00", "offset"}},
      {room + "[site]\nlatitude = 91\nlongitude = 2\n[sun]\nirradiance = 1\ntime = 2024-06-21T12:00:00Z\n",
       {"scene.toml:5: site.latitude: found 91"}},
      {room + "[sky]\nkind = \"cloudy\"\n", {"scene.toml:5: sky.kind: found 'cloudy'", "'overcast'"}},
      {room + "[sky]\nkind = \"overcast\"\nilluminance = 1\nirradiance = 1\n",
       {"scene.toml:4: sky", "expected one of"}},
      {room + "[sky]\nkind = \"clear\"\nilluminance = 1\n", {"scene.toml:5: ", "[sun]"}},
      {room + "[sky]\nkind = \"clear\"\nilluminance = 1\n[sun]\ndirection = [0, 0, -1]\n", {"below the horizon"}},
      {room + "[sky]\nkind = \"perez\"\ndirect_normal = 1\ndiffuse_horizontal = 1\n", {"scene.toml:4: ", "[sun]"}},
      {room + "[sky]\nkind = \"perez\"\ndirect_normal = 1\ndiffuse_horizontal = 1\n[sun]\ndirection = [0,0,1]\n"
              "irradiance = 1\n",
       {"scene.toml:10: sun.irradiance"}},
      {room + "[sky]\nkind = \"perez\"\ndirect_normal = 700\ndiffuse_horizontal = 1\n[sun]\ndirection = [0.8,0,-0.6]\n",
       {"sky.direct_normal: found 700 W/m^2 while the sun is 36.9 degrees below the horizon"}},
      {room + "[ground]\nreflectance = 0.2\n", {"scene.toml:4: ", "[sky]"}},
      {"north = [0, 0, 1]\n" + room, {"scene.toml:1: north"}},
      {room + "[weather]\nfile = \"a.epw\"\nmonth = 13\nday = 1\nhour = 1\n",
       {"scene.toml:6: weather.month: found 13"}},
      {room + "[weather]\nfile = \"a.epw\"\nmonth = 1.5\nday = 1\nhour = 1\n",
       {"scene.toml:6: weather.month: found 1.5"}},
      {room + "[weather]\nfile = \"a.epw\"\nmonth = 1\nday = 1\nhour = 1\n", {"a.epw", "does not exist"}},
      {room + "[weather]\n[sky]\n", {"scene.toml:5: ", "[weather]"}},
  };
  for (const auto& [toml, parts] : cases) {
    SCOPED_TRACE(toml);
    expect_refused(toml, parts);
  }
}

}  // namespace
}  // namespace patchlight::scene_lights_test
