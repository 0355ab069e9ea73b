#include "input/stated_unit.h"

#include <gtest/gtest.h>

namespace patchlight::stated_unit_test {
namespace {

TEST(StatedUnit, OfColladaIsItsAttributeMeter) {
  EXPECT_EQ(collada_unit("<COLLADA><asset><unit name=\"inch\" meter=\"0.0254\"/></asset>"), 0.0254);
  EXPECT_EQ(collada_unit("<asset><unit meter='0.01' name='cm'/>"), 0.01);
  EXPECT_EQ(collada_unit("<asset/>"), 1);
}

TEST(StatedUnit, OfIfcIsItsPrefixOrItsConversion) {
  EXPECT_EQ(
      ifc_unit("#7=IFCSIUNIT(*,.AREAUNIT.,$,.SQUARE_METRE.);\n#8 = IFCSIUNIT(*, .LENGTHUNIT., .MILLI., .METRE.);"),
      0.001);
  EXPECT_EQ(ifc_unit("#8=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);"), 1);
  EXPECT_EQ(ifc_unit("#8=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);#9=IFCCONVERSIONBASEDUNIT(#10,.LENGTHUNIT.,'FOOT',#11);"),
            0.3048);
}

}  // namespace
}  // namespace patchlight::stated_unit_test
