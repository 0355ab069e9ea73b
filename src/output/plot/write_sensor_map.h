#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/gather/readings.h"
#include "patchlight/scene/sensor.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A straight piece of an isoline: (column, row) of both ends, in steps of the lattice.
using IsolinePiece = std::array<Eigen::Vector2d, 2>;

/// Where values at the points of a lattice, linear between neighbors, have this level (marching squares, Lorensen and
/// Cline 1987 in the plane); nothing next to points that have no number.
std::vector<IsolinePiece> isoline(const Eigen::MatrixXd& values, double level);

/// The axes of a map of sensors, unit vectors.
struct MapAxes {
  Vector right, above;
};

/// Level sensors are seen from above with north above, others from the side that they face, `normal`.
inline MapAxes map_axes(const Vector& normal, const Vector& up, const Vector& north) {
  if (std::abs(normal.dot(up)) > 0.7) return {north.cross(up).normalized(), north};
  const Vector right = up.cross(normal).normalized();
  return {right, normal.cross(right).normalized()};
}

/// The quantity on a map of sensors.
enum class MapQuantity : std::uint8_t {
  illuminance,     ///< in lx; irradiance in W/m^2 where lights are not photometric
  daylight_factor  ///< in percent
};

/// How a map shows it.
struct MapOptions {
  MapQuantity quantity = MapQuantity::illuminance;
  std::optional<std::array<double, 2>> range = {};  ///< of the colors; none: from 0 to a round number
  Vector up = Vector::UnitZ();
  Vector north = Vector::UnitY();
  bool north_known = false;                                      ///< an arrow shows it
  std::vector<std::vector<std::array<Point, 2>>> sections = {};  ///< per grid the lines in which its plane cuts the
                                                                 ///< model, section_of(); empty: no walls are shown
};

/// Writes maps of all grids of sensors (.svg, .png): false colors of their cells, isolines at the legend's numbers,
/// walls around them, a scale bar; mean, least value and uniformity below each. Level grids are seen from above with
/// north above, others from the side that they face. \throws OutputError when there is no grid, or no daylight factor.
void write_sensor_map(const std::filesystem::path& file, std::span<const SensorGroup> groups, const Readings& readings,
                      const MapOptions& options = {});

}  // namespace patchlight
