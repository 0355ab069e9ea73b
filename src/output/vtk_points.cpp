#include "output/vtk_points.h"

#include "light/colour.h"
#include "output/vtk_polygons.h"

#include <string>
#include <vector>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPoints.h>

namespace patchlight {
namespace {

// A sensor with its place in the table.
struct Row {
  const SensorGroup* group = nullptr;
  int group_number = 0;
  std::size_t k = 0;       // in the group
  std::size_t sensor = 0;  // in the table
};

// Sensors without a cell first: VTK puts vertices before polygons.
std::vector<Row> rows_of(std::span<const SensorGroup> groups) {
  std::vector<Row> rows;
  for (const bool cells : {false, true}) {
    std::size_t first = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::size_t count = groups[g].sensors.size();
      for (std::size_t k = 0; k < count && cells == !groups[g].cells.empty(); ++k) {
        rows.push_back({&groups[g], static_cast<int>(g), k, first + k});
      }
      first += count;
    }
  }
  return rows;
}

Pointer<vtkPolyData> shape_of(const std::vector<Row>& rows) {
  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  const vtkNew<vtkCellArray> vertices, polygons;
  for (const Row& row : rows) {
    if (row.group->cells.empty()) {
      const vtkIdType corner = points->InsertNextPoint(row.group->sensors[row.k].point.data());
      vertices->InsertNextCell(1, &corner);
    } else {
      polygons->InsertNextCell(4);
      for (const Point& corner : row.group->cells[row.k]) {
        polygons->InsertCellPoint(points->InsertNextPoint(corner.data()));
      }
    }
  }
  auto shape = Pointer<vtkPolyData>::New();
  shape->SetPoints(points);
  shape->SetVerts(vertices);
  shape->SetPolys(polygons);
  return shape;
}

// The rows of a field in the order of the cells.
Field in_order(const Field& field, const std::vector<Row>& rows) {
  Field ordered(field.rows(), field.cols());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ordered.row(static_cast<Eigen::Index>(k)) = field.row(static_cast<Eigen::Index>(rows[k].sensor));
  }
  return ordered;
}

void add_values(vtkPolyData& shape, const std::vector<Row>& rows, const Readings& readings) {
  vtkCellData& data = *shape.GetCellData();
  data.AddArray(floats("irradiance", in_order(readings.irradiance, rows)));
  data.AddArray(floats("irradiance_standard_error", in_order(readings.standard_error, rows)));
  for (const auto& [name, part] : parts_of(readings.errors)) {
    if (part->size() > 0)
      data.AddArray(floats((std::string("irradiance_standard_error_") + name).c_str(), in_order(*part, rows)));
  }
  std::vector<double> values, errors, daylight;
  std::vector<int> groups, sensors, inside_walls;
  Field normals(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const SensorValue value = sensor_value(readings, rows[k].sensor);
    values.push_back(value.value);
    errors.push_back(value.standard_error);
    if (readings.outside_by_sky) daylight.push_back(daylight_factor(readings, rows[k].sensor));
    groups.push_back(rows[k].group_number);
    sensors.push_back(static_cast<int>(rows[k].sensor));
    inside_walls.push_back(is_inside_wall(readings, rows[k].sensor) ? 1 : 0);
    normals.row(static_cast<Eigen::Index>(k)) = rows[k].group->sensors[rows[k].k].normal.transpose();
  }
  const std::string name = readings.photometric ? "illuminance" : "weighted_irradiance";
  data.AddArray(numbers<vtkFloatArray>(name.c_str(), values));
  data.AddArray(numbers<vtkFloatArray>((name + "_standard_error").c_str(), errors));
  if (are_of_wavelengths(readings.bands)) {
    const Field xyz = xyz_rows(in_order(readings.irradiance, rows), readings.bands);
    data.AddArray(floats("xyz", xyz));
    data.AddArray(numbers<vtkFloatArray>("cct", colour_temperatures(xyz)));
  }
  if (readings.outside_by_sky) data.AddArray(numbers<vtkFloatArray>("daylight_factor", daylight));
  data.AddArray(numbers<vtkIntArray>("group", groups));
  data.AddArray(numbers<vtkIntArray>("sensor", sensors));
  data.AddArray(numbers<vtkIntArray>("inside_wall", inside_walls));
  data.AddArray(floats("normal", normals));
  data.SetActiveScalars(name.c_str());
}

std::vector<std::string> units_of(const Readings& readings) {
  std::vector<std::string> all = {"irradiance and its standard error: W/m^2"};
  all.push_back(readings.photometric ? "illuminance and its standard error: lx"
                                     : "weighted_irradiance and its standard error: W/m^2");
  if (are_of_wavelengths(readings.bands)) all.emplace_back("xyz: lx; cct: K, not a number where it has no meaning");
  if (readings.outside_by_sky) all.emplace_back("daylight_factor: percent");
  return all;
}

}  // namespace

void write_points_for_paraview(const std::filesystem::path& file, std::span<const SensorGroup> groups,
                               const Readings& readings) {
  const std::vector<Row> rows = rows_of(groups);
  const Pointer<vtkPolyData> shape = shape_of(rows);
  add_values(*shape, rows, readings);
  std::vector<std::string> names;
  for (const SensorGroup& group : groups) names.push_back(group.name);
  shape->GetFieldData()->AddArray(strings("group_names", names));
  shape->GetFieldData()->AddArray(strings("units", units_of(readings)));
  write_polygons(file, *shape);
}

}  // namespace patchlight
