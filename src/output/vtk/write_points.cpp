#include "patchlight/gather/readings.h"

#include "light/photometry.h"
#include "output/file/whole_file.h"
#include "output/vtk/vtk_polygons.h"
#include "output/vtk/write_vtk.h"

#include <cassert>
#include <filesystem>
#include <iomanip>
#include <sstream>
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
  name_components(data, readings.bands);
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

// The readings as VTK XML PolyData. Cell arrays: irradiance, irradiance_standard_error, illuminance or
// weighted_irradiance with its standard error, daylight_factor where there is one, normal, group (its number),
// sensor (its row in the table) and inside_wall (1 or 0; the values there are NaN). FieldData: group_names, units.
// Cells come in VTK's order: vertices first, then polygons. Throws OutputError.
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

// ",E_r,E_g,E_b", or ",E_1,E_2" for other bands than three.
std::string band_columns(const std::string& quantity, const Bands& bands) {
  std::string names;
  for (const Band& band : bands) names += "," + csv_cell(quantity + "_" + band.name);
  return names;
}

std::string header(const Readings& readings) {
  const Bands& bands = readings.bands;
  std::string names = "x,y,z,nx,ny,nz" + band_columns("E", bands) + band_columns("SE", bands);
  for (const auto& [name, part] : parts_of(readings.errors)) {
    if (part->size() > 0) names += band_columns(std::string("SE_") + name, bands);
  }
  if (readings.photometric) names += ",E_v_lx,SE_v_lx";
  if (are_of_wavelengths(bands)) names += ",X_lx,Y_lx,Z_lx,CCT_K";
  if (readings.outside_by_sky) names += ",daylight_factor_percent";
  return names + ",inside_wall,group\n";
}

void add_position(std::ostream& text, const SensorGroup& group, std::size_t k) {
  if (!group.columns.empty()) {
    text << group.columns[k];
    return;
  }
  const auto [point, normal] = group.sensors[k];
  text << point.x() << ',' << point.y() << ',' << point.z();
  for (const double component : normal) text << ',' << component + 0.0;  // no minus before a zero
}

void add_values(std::ostream& text, const Readings& readings, std::size_t sensor) {
  const auto row = static_cast<Eigen::Index>(sensor);
  for (const Field* const field : {&readings.irradiance, &readings.standard_error}) {
    for (const double value : field->row(row)) text << ',' << value;
  }
  for (const auto& [name, part] : parts_of(readings.errors)) {
    if (part->size() == 0) continue;
    for (const double value : part->row(row)) text << ',' << value;
  }
  const SensorValue value = sensor_value(readings, sensor);
  if (readings.photometric) text << ',' << value.value << ',' << value.standard_error;
  if (are_of_wavelengths(readings.bands)) {
    const Eigen::Vector3d xyz = xyz_of(readings.irradiance.row(row), readings.bands);
    for (const double component : xyz) text << ',' << component;
    text << ',';
    if (const std::optional<double> kelvin = correlated_colour_temperature(xyz)) text << *kelvin;
  }
  if (readings.outside_by_sky) text << ',' << daylight_factor(readings, sensor);
}

std::string table(std::span<const SensorGroup> groups, const Readings& readings) {
  std::ostringstream text;
  text << header(readings) << std::setprecision(9);
  std::size_t sensor = 0;
  for (const SensorGroup& group : groups) {
    for (std::size_t k = 0; k < group.sensors.size(); ++k, ++sensor) {
      add_position(text, group, k);
      add_values(text, readings, sensor);
      text << ',' << is_inside_wall(readings, sensor) << ',' << csv_cell(group.name) << '\n';
    }
  }
  assert(static_cast<Eigen::Index>(sensor) == readings.irradiance.rows());
  return text.str();
}

}  // namespace

std::vector<std::string> points_extensions() { return {".csv", ".vtp"}; }

void write_points(const std::filesystem::path& file, std::span<const SensorGroup> groups, const Readings& readings) {
  if (file.extension() == ".vtp") return write_points_for_paraview(file, groups, readings);
  write_bytes(file, table(groups, readings));
}

}  // namespace patchlight
