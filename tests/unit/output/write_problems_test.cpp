#include "output/report/write_checks.h"
#include "output/vtk/write_vtk.h"
#include "scene/repair.h"
#include "support/scenes.h"
#include "temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

namespace patchlight::write_problems_test {
namespace {

using namespace test;

// A cube on lines 1 to 6, a duplicate of its floor, and a face without area.
Scene messy_cube() {
  Scene scene = cube_room(0.5, 1);
  scene = with_quad(std::move(scene), box_faces(Point(0, 0, 0), Point(1, 1, 1), true)[0]);
  scene = with_polygon(std::move(scene), {Point(0, 0, 0), Point(0.5, 0, 0), Point(1, 0, 0)});
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) scene.polygons[p].line = p + 1;
  return repair(std::move(scene));
}

TEST(WriteProblems, MarksBadFacesAndKeepsTheOthers) {
  const TemporaryFolder folder;
  const Scene scene = messy_cube();
  write_problems(folder.path() / "problems.vtp", scene, survey(scene));
  const vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder.path() / "problems.vtp").c_str());
  reader->Update();
  vtkPolyData& polygons = *reader->GetOutput();
  // The duplicate floor and the face without area come first, then the six faces without problems.
  ASSERT_EQ(polygons.GetNumberOfCells(), 8);
  const auto value = [&](const char* name, vtkIdType cell) {
    return polygons.GetCellData()->GetArray(name)->GetTuple1(cell);
  };
  EXPECT_EQ(value("problem_kind", 0), 1);
  EXPECT_EQ(value("severity", 0), 2);
  EXPECT_EQ(value("source_line", 0), 7);
  EXPECT_EQ(value("problem_kind", 1), 2);
  EXPECT_EQ(value("severity", 1), 1);
  EXPECT_EQ(value("source_line", 1), 8);
  for (vtkIdType cell = 2; cell < 8; ++cell) {
    EXPECT_EQ(value("problem_kind", cell), 0);
    EXPECT_EQ(value("source_line", cell), cell - 1);
  }
}

TEST(SurveyJson, HoldsTheReport) {
  const Scene scene = messy_cube();
  const SceneReport report = survey(scene);
  const nlohmann::json json = nlohmann::json::parse(survey_json(scene, report));
  EXPECT_EQ(json["usable"], true);
  EXPECT_EQ(json["polygons"], 6);
  EXPECT_EQ(json["lamps"], 6);
  EXPECT_EQ(json["closed_shells"], 1);
  EXPECT_EQ(json["materials"][0]["area_m2"], 6.0);
  ASSERT_EQ(json["problems"].size(), 2U);
  EXPECT_EQ(json["problems"][0]["kind"], "duplicate_faces");
  EXPECT_EQ(json["problems"][0]["severity"], "warning");
  EXPECT_EQ(json["problems"][0]["count"], 1);
  EXPECT_EQ(json["problems"][0]["faces"][0]["line"], 7);
  EXPECT_EQ(json["problems"][1]["kind"], "zero_area");
}

}  // namespace
}  // namespace patchlight::write_problems_test
