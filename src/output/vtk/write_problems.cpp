#include "output/vtk/write_problems.h"

#include "output/vtk/vtk_polygons.h"

#include <algorithm>
#include <map>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>

namespace patchlight {
namespace {

// One cell of the file.
struct Cell {
  const ModelFace* face;
  int problem;   // 0: none; else the place of the problem in the report, from 1
  int severity;  // 0 nothing to 3 error
};

ModelFace face_of(const Scene& scene, PolygonIndex p) {
  const Polygon& polygon = scene.polygons[p];
  return {corner_points(scene, p), polygon.file, polygon.line, polygon.face};
}

int number_of(Severity severity) { return 3 - static_cast<int>(severity); }

// The faces of all problems that can be drawn, then the polygons that no problem concerns.
std::vector<Cell> cells_of(const SceneReport& report, const std::vector<ModelFace>& polygons) {
  std::vector<Cell> cells;
  std::map<std::uint32_t, bool> is_bad;
  for (std::size_t k = 0; k < report.diagnostics.size(); ++k) {
    const Diagnostic& problem = report.diagnostics[k];
    for (const ModelFace& face : problem.faces) {
      if (face.corners.empty()) continue;
      cells.push_back({&face, static_cast<int>(k) + 1, number_of(severity_of(problem.code))});
      is_bad[face.face] = true;
    }
  }
  for (const ModelFace& polygon : polygons) {
    if (!is_bad.contains(polygon.face)) cells.push_back({&polygon, 0, 0});
  }
  return cells;
}

template <class Value>
void add_numbers(vtkPolyData& polygons, const char* name, const std::vector<Cell>& cells, Value value) {
  const vtkNew<vtkIntArray> array;
  array->SetName(name);
  for (const Cell& cell : cells) array->InsertNextValue(static_cast<int>(value(cell)));
  polygons.GetCellData()->AddArray(array);
}

void add_strings(vtkPolyData& polygons, const char* name, const std::vector<std::string>& values) {
  const vtkNew<vtkStringArray> array;
  array->SetName(name);
  for (const std::string& value : values) array->InsertNextValue(value);
  polygons.GetFieldData()->AddArray(array);
}

}  // namespace

void write_problems(const std::filesystem::path& file, const Scene& scene, const SceneReport& report) {
  std::vector<ModelFace> all;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) all.push_back(face_of(scene, p));
  const std::vector<Cell> cells = cells_of(report, all);

  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const vtkNew<vtkCellArray> outlines;
  for (const Cell& cell : cells) {
    // A face of which one or two corners are left repeats the last.
    const std::size_t least = 3;
    const std::vector<Point>& corners = cell.face->corners;
    const std::size_t count = std::max(least, corners.size());
    outlines->InsertNextCell(static_cast<int>(count));
    for (std::size_t k = 0; k < count; ++k) {
      outlines->InsertCellPoint(points->InsertNextPoint(corners[std::min(k, corners.size() - 1)].data()));
    }
  }
  const vtkNew<vtkPolyData> polygons;
  polygons->SetPoints(points);
  polygons->SetPolys(outlines);
  add_numbers(*polygons, "problem_kind", cells, [](const Cell& cell) { return cell.problem; });
  add_numbers(*polygons, "severity", cells, [](const Cell& cell) { return cell.severity; });
  add_numbers(*polygons, "source_file", cells, [](const Cell& cell) { return cell.face->file; });
  add_numbers(*polygons, "source_line", cells, [](const Cell& cell) { return cell.face->line; });
  add_numbers(*polygons, "source_polygon", cells, [](const Cell& cell) { return cell.face->face; });
  polygons->GetCellData()->SetActiveScalars("problem_kind");

  std::vector<std::string> names = {"nothing wrong"};
  std::vector<std::string> sentences = {""};
  for (const Diagnostic& problem : report.diagnostics) {
    names.emplace_back(name_of(problem.code));
    sentences.push_back(problem.text);
  }
  add_strings(*polygons, "problem_names", names);
  add_strings(*polygons, "problem_sentences", sentences);
  add_strings(*polygons, "source_files", scene.files.empty() ? std::vector{scene.file} : scene.files);
  write_polygons(file, *polygons);
}

}  // namespace patchlight
