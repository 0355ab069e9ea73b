#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/scene/sensor.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// What a map of sensors shows.
enum class MapQuantity : std::uint8_t {
  illuminance,     ///< in lx; irradiance in W/m^2 where lights are not photometric
  daylight_factor  ///< in percent
};

/// How it shows that.
struct MapOptions {
  MapQuantity quantity = MapQuantity::illuminance;
  std::optional<std::array<double, 2>> range = {};  ///< of the colours; none: from 0 to a round number
  Vector up = Vector::UnitZ();
  Vector north = Vector::UnitY();
  bool north_known = false;                                      ///< an arrow shows it
  std::vector<std::vector<std::array<Point, 2>>> sections = {};  ///< per grid the lines in which its plane cuts the
                                                                 ///< model, section_of(); empty: no walls are shown
};

/// Writes maps of all grids of sensors (.svg, .png): false colours of their cells, isolines at the legend's numbers,
/// walls around them, a scale bar; mean, least value and uniformity below each. Level grids are seen from above with
/// north above, others from the side that they face. \throws OutputError when there is no grid, or no daylight factor.
void write_sensor_map(const std::filesystem::path& file, std::span<const SensorGroup> groups, const Readings& readings,
                      const MapOptions& options = {});

}  // namespace patchlight
