#include "output/write_points.h"

#include "light/colour.h"
#include "output/csv_cell.h"
#include "output/vtk_points.h"
#include "output/write_bytes.h"

#include <cassert>
#include <iomanip>
#include <optional>
#include <sstream>

namespace patchlight {
namespace {

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
