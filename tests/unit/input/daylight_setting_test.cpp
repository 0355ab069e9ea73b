#include "patchlight/input/read_scene.h"

#include "model_files.h"

namespace patchlight::daylight_setting_test {
namespace {

const std::string room = "up = \"z\"\n[[model]]\nfile = \"room.obj\"\n";

class Daylight : public ModelFiles {
 protected:
  Daylight() { write("room.obj", "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nf 1 2 3 4\n"); }
  Scene with(const DaylightSetting& setting) const {
    ReadOptions options;
    options.up = Vector::UnitZ();
    options.daylight = setting;
    return read_scene(folder_ / "room.obj", options);
  }
  std::string refusal_of(const DaylightSetting& setting) const {
    try {
      with(setting);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

void expect_same(const Scene& found, const Scene& expected) {
  ASSERT_EQ(found.sky.has_value(), expected.sky.has_value());
  ASSERT_EQ(found.sun.has_value(), expected.sun.has_value());
  if (found.sun) {
    EXPECT_TRUE(found.sun->direction.isApprox(expected.sun->direction, 1e-14));
    EXPECT_TRUE((found.sun->normal_irradiance == expected.sun->normal_irradiance).all());
  }
  if (!found.sky) return;
  EXPECT_EQ(found.sky->kind, expected.sky->kind);
  EXPECT_TRUE(found.sky->horizontal_irradiance.isApprox(expected.sky->horizontal_irradiance, 1e-14));
  EXPECT_TRUE(found.sky->ground_radiance.isApprox(expected.sky->ground_radiance, 1e-14));
  EXPECT_TRUE(found.photometric);
}

// The settings of a scene file in the words of its keys.
TEST_F(Daylight, IsThatOfASceneFile) {
  DaylightSetting overcast;
  overcast.sky = SkyKind::cie_overcast;
  overcast.sky_illuminance = 8000;
  overcast.ground_reflectance = 0.3;
  expect_same(
      with(overcast),
      read_scene(write("overcast.toml",
                       room + "[sky]\nkind = \"overcast\"\nilluminance = 8000\n[ground]\nreflectance = 0.3\n")));

  DaylightSetting clear;
  clear.sky = SkyKind::cie_clear;
  clear.sun = DaylightSetting::SunPlace{30, 90};  // in the east
  clear.sun_illuminance = 50000;
  expect_same(with(clear),
              read_scene(write("clear.toml", room + "[sky]\nkind = \"clear\"\nilluminance = 10000\n"
                                                    "[sun]\ndirection = [0.8660254037844387, 0, 0.5]\n"
                                                    "illuminance = 50000\n[ground]\nreflectance = 0.2\n")));

  DaylightSetting measured;
  measured.sky = SkyKind::perez;
  measured.sun = DaylightSetting::SunPlace{30, 90, 1};
  measured.measured = SolarIrradiance{400, 120};
  expect_same(with(measured),
              read_scene(write("perez.toml", room + "[sky]\nkind = \"perez\"\ndirect_normal = 400\n"
                                                    "diffuse_horizontal = 120\n[sun]\n"
                                                    "direction = [0.8660254037844387, 0, 0.5]\n[ground]\n"
                                                    "reflectance = 0.2\n")));
}

TEST_F(Daylight, IsRefusedWhereItsPartsDoNotFit) {
  DaylightSetting no_sun;
  no_sun.sky = SkyKind::cie_clear;
  EXPECT_NE(refusal_of(no_sun).find("read.daylight.sun"), std::string::npos);
  DaylightSetting weak;
  weak.sun = DaylightSetting::SunPlace{};
  EXPECT_NE(refusal_of(weak).find("illuminance missing"), std::string::npos);
  DaylightSetting ground;
  ground.ground_reflectance = 0.1;
  EXPECT_NE(refusal_of(ground).find("needs a sky"), std::string::npos);
  DaylightSetting both;
  both.sky = SkyKind::uniform;
  both.weather = DaylightSetting::WeatherFile{"city.epw"};
  EXPECT_NE(refusal_of(both).find("read.daylight.weather"), std::string::npos);
  DaylightSetting below;
  below.sky = SkyKind::cie_clear;
  below.sun = DaylightSetting::SunPlace{-5, 180};
  EXPECT_NE(refusal_of(below).find("below the horizon"), std::string::npos);
}

// There is one sky: a setting beside the scene file replaces the file's sky.
TEST_F(Daylight, BesideTheFileTakesThePlaceOfItsOwn) {
  const auto file = write("sky.toml", room + "[sky]\nkind = \"overcast\"\nilluminance = 8000\n");
  ReadOptions options;
  options.daylight.sky = SkyKind::uniform;
  const Scene scene = read_scene(file, options);
  ASSERT_TRUE(scene.sky.has_value());
  EXPECT_EQ(scene.sky->kind, SkyKind::uniform);
}

}  // namespace
}  // namespace patchlight::daylight_setting_test
