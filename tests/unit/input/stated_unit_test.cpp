#include "input/read_model.h"

#include <gtest/gtest.h>

namespace patchlight::stated_unit_test {
namespace {

TEST(StatedUnit, OfColladaIsItsAttributeMeter) {
  EXPECT_EQ(collada_unit("<COLLADA><asset><unit name=\"inch\" meter=\"0.0254\"/></asset>"), 0.0254);
  EXPECT_EQ(collada_unit("<asset><unit meter='0.01' name='cm'/>"), 0.01);
  EXPECT_EQ(collada_unit("<asset/>"), 1);
}

}  // namespace
}  // namespace patchlight::stated_unit_test
