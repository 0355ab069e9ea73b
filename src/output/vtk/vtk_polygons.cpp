#include "output/vtk/vtk_polygons.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "output/vtk/write_vtk.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCommand.h>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

namespace patchlight {
namespace {

// The first error that VTK reports, kept instead of printed.
void keep_first_error(vtkObject*, unsigned long, void* message, void* text) {
  auto& kept = *static_cast<std::string*>(message);
  if (kept.empty() && text != nullptr) kept = static_cast<const char*>(text);
}

void write_data(const std::filesystem::path& file, vtkDataSet& data, vtkXMLWriter& writer) {
  write_whole_file(file, [&](const std::filesystem::path& temporary) {
    std::string error;
    const vtkNew<vtkCallbackCommand> on_error;
    on_error->SetCallback(keep_first_error);
    on_error->SetClientData(&error);
    writer.AddObserver(vtkCommand::ErrorEvent, on_error);
    writer.GetExecutive()->AddObserver(vtkCommand::ErrorEvent, on_error);
    writer.SetInputData(&data);
    writer.SetFileName(temporary.c_str());
    writer.SetDataModeToAppended();
    writer.SetHeaderTypeToUInt64();
    const bool written = writer.Write() != 0 && writer.GetErrorCode() == vtkErrorCode::NoError && error.empty();
    if (!written) throw OutputError(file.string(), "cannot be written; is the disk full?");
  });
}

// Without facts that are texts or empty: meshio, which reads such grids, takes neither.
Pointer<vtkUnstructuredGrid> grid_of(vtkPolyData& polygons) {
  auto grid = Pointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(polygons.GetPoints());
  vtkCellArray& cells = *polygons.GetPolys();
  const vtkNew<vtkUnsignedCharArray> types;
  for (vtkIdType k = 0; k < cells.GetNumberOfCells(); ++k)
    types->InsertNextValue(cells.GetCellSize(k) == 3 ? VTK_TRIANGLE : VTK_QUAD);
  grid->SetCells(types, &cells);
  grid->GetCellData()->ShallowCopy(polygons.GetCellData());
  grid->GetPointData()->ShallowCopy(polygons.GetPointData());
  vtkFieldData& facts = *polygons.GetFieldData();
  for (int k = 0; k < facts.GetNumberOfArrays(); ++k) {
    vtkDataArray* const numbers = facts.GetArray(k);
    if (numbers != nullptr && numbers->GetNumberOfTuples() > 0) grid->GetFieldData()->AddArray(numbers);
  }
  return grid;
}

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
  std::set<std::uint32_t> bad;
  for (std::size_t k = 0; k < report.diagnostics.size(); ++k) {
    const Diagnostic& problem = report.diagnostics[k];
    for (const ModelFace& face : problem.faces) {
      if (face.corners.empty()) continue;
      cells.push_back({&face, static_cast<int>(k) + 1, number_of(severity_of(problem.code))});
      bad.insert(face.face);
    }
  }
  for (const ModelFace& polygon : polygons) {
    if (!bad.contains(polygon.face)) cells.push_back({&polygon, 0, 0});
  }
  return cells;
}

Pointer<vtkPolyData> shape_of(const std::vector<Cell>& cells) {
  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const vtkNew<vtkCellArray> outlines;
  for (const Cell& cell : cells) {
    // A face of which one or two corners are left repeats the last.
    const std::vector<Point>& corners = cell.face->corners;
    const std::size_t count = std::max<std::size_t>(3, corners.size());
    outlines->InsertNextCell(static_cast<int>(count));
    for (std::size_t k = 0; k < count; ++k)
      outlines->InsertCellPoint(points->InsertNextPoint(corners[std::min(k, corners.size() - 1)].data()));
  }
  auto polygons = Pointer<vtkPolyData>::New();
  polygons->SetPoints(points);
  polygons->SetPolys(outlines);
  return polygons;
}

}  // namespace

Pointer<vtkPolyData> polygons_of(const PatchMesh& mesh) {
  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.vertices.size()));
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k)
    points->SetPoint(static_cast<vtkIdType>(k), mesh.vertices[k].data());
  const vtkNew<vtkCellArray> cells;
  for (const auto& corners : mesh.corners) {
    const bool triangle = corners[2] == corners[3];
    cells->InsertNextCell(triangle ? 3 : 4);
    for (std::size_t k = 0; k < (triangle ? 3U : 4U); ++k) cells->InsertCellPoint(corners[k]);
  }
  auto polygons = Pointer<vtkPolyData>::New();
  polygons->SetPoints(points);
  polygons->SetPolys(cells);
  return polygons;
}

Pointer<vtkFloatArray> floats(const char* name, const FieldView& values) {
  auto array = Pointer<vtkFloatArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(static_cast<int>(values.cols()));
  array->SetNumberOfTuples(values.rows());
  float* out = array->GetPointer(0);
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    for (Eigen::Index band = 0; band < values.cols(); ++band) *out++ = static_cast<float>(values(row, band));
  }
  return array;
}

void name_components(vtkFieldData& data, const Bands& bands) {
  std::vector<std::string> of_bands;
  for (const Band& band : bands) of_bands.push_back(band.name);
  for (int k = 0; k < data.GetNumberOfArrays(); ++k) {
    vtkDataArray* const array = data.GetArray(k);
    if (array == nullptr || array->GetName() == nullptr) continue;
    const std::string_view name = array->GetName();
    std::vector<std::string> names = of_bands;
    if (name.starts_with("rgb")) names = {"r", "g", "b"};
    if (name == "xyz") names = {"X", "Y", "Z"};
    if (name == "normal") names = {"x", "y", "z"};
    const int count = array->GetNumberOfComponents();
    if (count == 1 || static_cast<std::size_t>(count) != names.size()) continue;
    for (int c = 0; c < count; ++c) array->SetComponentName(c, names[static_cast<std::size_t>(c)].c_str());
  }
}

Pointer<vtkUnsignedCharArray> colours(const char* name, const std::vector<std::array<std::uint8_t, 3>>& values) {
  auto array = Pointer<vtkUnsignedCharArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  std::uint8_t* out = array->GetPointer(0);
  for (const auto& value : values) out = std::copy(value.begin(), value.end(), out);
  return array;
}

Pointer<vtkStringArray> strings(const std::string& name, const std::vector<std::string>& values) {
  auto array = Pointer<vtkStringArray>::New();
  array->SetName(name.c_str());
  for (const std::string& value : values) array->InsertNextValue(value);
  return array;
}

void write_polygons(const std::filesystem::path& file, vtkPolyData& polygons) {
  const vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetCompressorTypeToLZ4();
  writer->EncodeAppendedDataOff();
  write_data(file, polygons, *writer);
}

void write_grid(const std::filesystem::path& file, vtkPolyData& polygons) {
  const vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetCompressorTypeToZLib();
  // Bytes as they are make no well-formed XML, and meshio takes one array's for another's in one of seven files.
  writer->EncodeAppendedDataOn();
  write_data(file, *grid_of(polygons), *writer);
}

void write_problems(const std::filesystem::path& file, const Scene& scene, const SceneReport& report) {
  std::vector<ModelFace> all;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) all.push_back(face_of(scene, p));
  const std::vector<Cell> cells = cells_of(report, all);

  const Pointer<vtkPolyData> polygons = shape_of(cells);
  const auto add = [&](const char* name, const auto& value_of) {
    std::vector<int> values;
    for (const Cell& cell : cells) values.push_back(static_cast<int>(value_of(cell)));
    polygons->GetCellData()->AddArray(numbers<vtkIntArray>(name, values));
  };
  add("problem_kind", [](const Cell& cell) { return cell.problem; });
  add("severity", [](const Cell& cell) { return cell.severity; });
  add("source_file", [](const Cell& cell) { return cell.face->file; });
  add("source_line", [](const Cell& cell) { return cell.face->line; });
  add("source_polygon", [](const Cell& cell) { return cell.face->face; });
  polygons->GetCellData()->SetActiveScalars("problem_kind");

  std::vector<std::string> names = {"nothing wrong"}, sentences = {""};
  for (const Diagnostic& problem : report.diagnostics) {
    names.emplace_back(name_of(problem.code));
    sentences.push_back(problem.text);
  }
  vtkFieldData& facts = *polygons->GetFieldData();
  facts.AddArray(strings("problem_names", names));
  facts.AddArray(strings("problem_sentences", sentences));
  facts.AddArray(strings("source_files", scene.files.empty() ? std::vector{scene.file} : scene.files));
  write_polygons(file, *polygons);
}

}  // namespace patchlight
