#pragma once

#include "patchlight/base/geometry.h"

namespace patchlight {

/// A place on earth, degrees; north and east are positive.
struct Place {
  double latitude = 0;
  double longitude = 0;
};

/// A date of the Gregorian calendar and a time in UTC.
struct Instant {
  int year = 2000;
  int month = 1;    ///< 1 to 12
  int day = 1;      ///< 1 to 31
  double hour = 0;  ///< since midnight; may lie outside 0 to 24, as a time zone leaves it
};

/// The position of the sun, degrees.
struct SolarPosition {
  double altitude = 0;  ///< above the horizon, without refraction
  double azimuth = 0;   ///< from north over east, 0 to 360
};

/// The sun's position by the low-accuracy solar coordinates of Meeus, Astronomical Algorithms (2nd ed. 1998), chapter
/// 25, and the sidereal time of chapter 12. Accurate to 0.01 degrees from 1900 to 2100. Neglects parallax, 0.0024
/// degrees, and refraction, 0.02 degrees at an altitude of 40 degrees and 0.5 at the horizon.
SolarPosition solar_position(const Place& place, const Instant& instant);

/// The unit vector towards a position of the sky; `up` and `north` are unit vectors at right angles.
Vector direction_to(const SolarPosition& position, const Vector& up, const Vector& north);

/// 1 on the first of January.
int day_of_year(const Instant& instant);

}  // namespace patchlight
