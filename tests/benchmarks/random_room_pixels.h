#pragma once

#include "patchlight/simulate.h"

#include "support/random_rooms.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace patchlight {

/// Three computations of the irradiance at a place of a surface, in one band, W/m^2.
struct PixelComparison {
  std::string room;
  std::string kind;                     ///< "elsewhere" for places outside of enclosed spaces by daylight
  std::string place;                    ///< position, normal and band, for messages
  double sensor = 0, sensor_error = 0;  ///< the error is the total
  double sensor_rays = 0;               ///< the part of the error by its own rays
  double pixel = 0, pixel_error = 0;    ///< the error is the scatter of the pixels alone
  double path = 0, path_error = 0;
};

/// Draws so many places on the opaque matte surfaces of a solved room. Compares sensors, pixels of final pictures, and
/// paths.
std::vector<PixelComparison> compare_pixels(const test::RandomRoom& room, const Simulation& simulation,
                                            std::size_t places, std::uint32_t paths, std::uint64_t seed);

/// The table of these comparisons.
std::string table_of(const std::vector<PixelComparison>& comparisons);

}  // namespace patchlight
