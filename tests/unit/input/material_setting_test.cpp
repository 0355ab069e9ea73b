#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"

#include <gtest/gtest.h>

namespace patchlight::material_setting_test {
namespace {

using Quantity = MaterialSetting::Quantity;

TEST(ParseMaterialSetting, ReadsMaterialQuantityAndValues) {
  const MaterialSetting setting = parse_material_setting("light.radiance=17,12,4.5");
  EXPECT_EQ(setting.material, "light");
  EXPECT_EQ(setting.quantity, Quantity::radiance);
  ASSERT_EQ(setting.value.size(), 3);
  EXPECT_EQ(setting.value[0], 17);
  EXPECT_EQ(setting.value[1], 12);
  EXPECT_EQ(setting.value[2], 4.5);
}

TEST(ParseMaterialSetting, OneValueStandsForAllBands) {
  const MaterialSetting setting = parse_material_setting("w.reflectance=0.25");
  EXPECT_EQ(setting.quantity, Quantity::reflectance);
  ASSERT_EQ(setting.value.size(), 1);
  EXPECT_EQ(setting.value[0], 0.25);
}

TEST(ParseMaterialSetting, ReadsAnIndexOfRefraction) {
  const MaterialSetting setting = parse_material_setting("glass.index=1.6");
  EXPECT_EQ(setting.quantity, Quantity::index);
  EXPECT_EQ(setting.value[0], 1.6);
}

TEST(ParseMaterialSetting, NamesMayHoldDotsAndEqualSigns) {
  EXPECT_EQ(parse_material_setting("Material.001.exitance=1").material, "Material.001");
  EXPECT_EQ(parse_material_setting("a=b.c.exitance=1").material, "a=b.c");
}

TEST(ParseMaterialSetting, RefusesEverythingElseNamingTheOption) {
  for (const char* text : {"", "light", "light=1", "light.radiance", ".radiance=1", "light.colour=1",
                           "light.radiance=", "light.radiance=1,2", "light.radiance=1,2,3,4", "light.radiance=1,,2",
                           "light.radiance=1,2,x", "light.radiance=nan", "light.radiance=inf", "light.exitance=-1",
                           "light.reflectance=0.5,0.5,1.01", "glass.index=0.99", "glass.index=1.5,1.5,1.6"}) {
    SCOPED_TRACE(text);
    try {
      parse_material_setting(text);
      FAIL() << "accepted";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("read.settings: ", 0), 0U) << error.what();
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
}

// The message about a rejected setting.
std::string refusal_of(const std::string& text) {
  try {
    parse_material_setting(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(ParseMaterialSetting, RefusalsTellQuantitiesWithTheirUnits) {
  const auto says = [](const std::string& text, const std::string& words) {
    EXPECT_NE(refusal_of(text).find(words), std::string::npos) << refusal_of(text);
  };
  for (const char* text : {"lamp.colour=1", "lamp.flux=800lm", "lamp"}) {
    for (const char* words : {"exitance (W/m^2)", "radiance (W/(m^2 sr))", "index"}) says(text, words);
  }
  for (const char* words : {"'800lm'", "W/m^2"}) says("lamp.exitance=800lm", words);
  for (const char* words : {"'10cd'", "W/(m^2 sr)"}) says("lamp.radiance=10cd", words);
  for (const char* words : {"'half'", "0 to 1"}) says("wall.reflectance=half", words);
}

// Phi = 179 lm/W * A * M for one exitance M in all bands.
TEST(ParseMaterialSetting, LumensAreAnExitanceByTheArea) {
  for (const char* text : {"lamp.flux=800lm", "lamp.lumens=800", "lamp.watts=60"}) {
    const std::string refusal = refusal_of(text);
    EXPECT_NE(refusal.find("\nhint: exitance = lumens / (179 "), std::string::npos) << refusal;
  }
  EXPECT_EQ(refusal_of("lamp.colour=1").find("lumens"), std::string::npos);
}

}  // namespace
}  // namespace patchlight::material_setting_test
