#include "plan/survey.h"

#include <gtest/gtest.h>

namespace patchlight::lamp_names_test {
namespace {

TEST(LampNames, AreFoundByWords) {
  for (const char* name : {"light", "Light.001", "ceiling_light", "CeilingLight2", "lamp", "floor lamp", "LIGHTS",
                           "Deckenleuchte", "emissive_panel", "bulb", "light source", "Luminaire-3"})
    EXPECT_TRUE(is_name_of_lamp(name)) << name;
}

TEST(LampNames, AreNotPartsOfOtherWordsOrColours) {
  for (const char* name : {"Concrete-CastinSituLightweight", "Skylight", "daylight glass", "Light Grey", "light_oak",
                           "LightBrown", "slight", "pipe clamp", "illumination", "plywood", ""})
    EXPECT_FALSE(is_name_of_lamp(name)) << name;
}

}  // namespace
}  // namespace patchlight::lamp_names_test
