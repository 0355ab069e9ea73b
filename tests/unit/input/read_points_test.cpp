#include "input/tables/read_tables.h"
#include "model_files.h"

namespace patchlight::read_points_test {
namespace {

class ReadPoints : public ModelFiles {};

TEST_F(ReadPoints, ReadsWhatRadianceUsersHave) {
  const auto file = write("room.pts", "1.50 2 0.8 0 0 1\r\n\n# comment\n\t1,2,3,0,-2,0 # more\n");
  const SensorGroup group = read_points(file, 0.01);
  ASSERT_EQ(group.sensors.size(), 2U);
  EXPECT_EQ(group.name, "room");
  EXPECT_EQ(group.sensors[0].point, Point(1.5, 2, 0.8) * 0.01);
  EXPECT_EQ(group.sensors[1].normal, Vector(0, -1, 0));
  EXPECT_EQ(group.columns[0], "1.50,2,0.8,0,0,1");
  EXPECT_EQ(group.lines, (std::vector<std::uint32_t>{1, 4}));
}

TEST_F(ReadPoints, RefusesWithFileAndLine) {
  const std::vector<std::pair<std::string, std::string>> cases = {{"1 2 3\n", ".pts:1: found 3 values"},
                                                                  {"\n1 2 x 0 0 1\n", ".pts:2: found 'x'"},
                                                                  {"1 2 nan 0 0 1\n", ".pts:1: found 'nan'"},
                                                                  {"1 2 3 0 0 0\n", ".pts:1: the direction"},
                                                                  {"# none\n", "found no points"}};
  for (const auto& [text, part] : cases) {
    SCOPED_TRACE(text);
    try {
      read_points(write("a.pts", text), 1);
      FAIL() << "was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace patchlight::read_points_test
