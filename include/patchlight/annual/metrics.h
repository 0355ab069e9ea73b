#pragma once

#include "patchlight/annual/annual.h"
#include "patchlight/scene/sensor.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The hours that count, from the first of January.
struct CountedHours {
  std::vector<std::uint8_t> occupied;  ///< 1 for each hour in which the rooms are used
  std::vector<std::uint8_t> daylight;  ///< 1 for each of the 4380 hours with the most light of the sky: EN 17037
};

/// Occupied is every day from `first` to before `last`, hours of the day. \throws InputError if there are none.
CountedHours counted_hours(const Year& year, const Scene& scene, int first, int last);

/// A measure and how far it may be off.
struct Measure {
  double value = 0;
  double standard_error = 0;
};

/// The measures of a sensor. Shares are of the occupied hours, in percent.
enum class SensorMeasure : std::size_t {
  mean_illuminance,  ///< lx, over the occupied hours
  autonomy,          ///< DA: at least 300 lx (Reinhart and Walkenhorst 2001)
  continuous,        ///< cDA: below 300 lx an hour counts by E / 300 lx (Rogers 2006)
  udi_below_100,     ///< useful daylight illuminance (Nabil and Mardaljevic 2005; Mardaljevic et al. 2012)
  udi_100_to_300,    ///< supplementary
  udi_300_to_3000,   ///< autonomous
  udi_above_3000,    ///< exceeded
  sunlit_hours,      ///< hours with more than 1000 lx of AnnualLight::sunlight (IES LM-83-12), not percent
  daylight_factor,   ///< percent, under a CIE overcast sky
  half_of_daylight   ///< lx that are reached in half of the daylight hours (EN 17037:2018)
};
inline constexpr std::size_t sensor_measures = 10;  ///< the number of measures

/// The measures of a room, or of all sensors. Means are over its sensors, without those inside walls.
enum class RoomMeasure : std::size_t {
  spatial_autonomy,   ///< sDA300/50%: percent of sensors with DA of at least 50 % (IES LM-83-12)
  sunlight_exposure,  ///< ASE1000/250: percent of sensors with more than 250 sunlit hours (IES LM-83-12)
  mean_illuminance,
  mean_autonomy,
  mean_continuous,
  mean_udi_below_100,
  mean_udi_100_to_300,
  mean_udi_300_to_3000,
  mean_udi_above_3000,
  median_daylight_factor,
  half_of_plane,  ///< lx that half of the sensors reach in half of the daylight hours (EN 17037, target)
  most_of_plane,  ///< lx that 95 % of the sensors reach in half of the daylight hours (EN 17037, minimum)
  grade           ///< EN 17037 table A.1: 0 none, 1 minimum, 2 medium, 3 high
};
inline constexpr std::size_t room_measures = 13;  ///< the number of measures

/// The name of a measure's column in tables.
const char* name_of(SensorMeasure measure);
/// The same for measures of rooms.
const char* name_of(RoomMeasure measure);

/// The measures of a room.
struct RoomYear {
  std::string name;
  std::size_t sensors = 0;
  std::size_t inside_walls = 0;
  std::array<Measure, room_measures> measures{};
};

/// The measures of sensors, rooms and the building.
struct AnnualMetrics {
  std::vector<std::array<Measure, sensor_measures>> sensors;  ///< not numbers inside walls
  std::vector<RoomYear> rooms;                                ///< one for each group
  RoomYear building;                                          ///< all sensors
  std::size_t occupied_hours = 0;
};

/// The measures of a year. Standard errors follow from AnnualLight::relative_error, as half of the difference between
/// the measures with all but the straight sunlight that much brighter and darker; for rooms an upper bound, as if all
/// sensors were off alike.
AnnualMetrics metrics_of(const AnnualLight& light, std::span<const SensorGroup> groups, const CountedHours& hours);

}  // namespace patchlight
