#include "light/solar_position.h"

#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr double degree = std::numbers::pi / 180;

// Days of the Gregorian calendar since noon of the first of January 4713 BC. Meeus 1998, eq. 7.1.
double julian_day(const Instant& instant) {
  const int year = instant.month > 2 ? instant.year : instant.year - 1;
  const int month = instant.month > 2 ? instant.month : instant.month + 12;
  const double century = std::floor(year / 100.0);
  const double leap = 2 - century + std::floor(century / 4);
  return std::floor(365.25 * (year + 4716)) + std::floor(30.6001 * (month + 1)) + instant.day + leap - 1524.5 +
         instant.hour / 24;
}

struct EquatorialPosition {
  double right_ascension = 0;  // radians
  double declination = 0;
};

// Apparent position of the sun, T in Julian centuries since 2000. Meeus 1998, eqs. 25.2 to 25.8.
EquatorialPosition sun_at(double T) {
  const double mean_longitude = 280.46646 + T * (36000.76983 + T * 0.0003032);
  const double anomaly = (357.52911 + T * (35999.05029 - T * 0.0001537)) * degree;
  const double centre = (1.914602 - T * (0.004817 + T * 0.000014)) * std::sin(anomaly) +
                        (0.019993 - 0.000101 * T) * std::sin(2 * anomaly) + 0.000289 * std::sin(3 * anomaly);
  const double node = (125.04 - 1934.136 * T) * degree;
  const double longitude = (mean_longitude + centre - 0.00569 - 0.00478 * std::sin(node)) * degree;
  const double obliquity = (23.439291 - 0.0130042 * T + 0.00256 * std::cos(node)) * degree;
  return {std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude)),
          std::asin(std::sin(obliquity) * std::sin(longitude))};
}

// Apparent sidereal time at Greenwich, radians. Meeus 1998, eq. 12.4 and the nutation's largest term.
double sidereal_time(double day, double T) {
  const double node = (125.04 - 1934.136 * T) * degree;
  const double nutation = -0.00478 * std::sin(node) * std::cos(23.44 * degree);
  return (280.46061837 + 360.98564736629 * (day - 2451545) + T * T * 0.000387933 + nutation) * degree;
}

}  // namespace

SolarPosition solar_position(const Place& place, const Instant& instant) {
  const double day = julian_day(instant);
  const double T = (day - 2451545) / 36525;
  const EquatorialPosition sun = sun_at(T);
  const double hour_angle = sidereal_time(day, T) + place.longitude * degree - sun.right_ascension;
  const double latitude = place.latitude * degree;
  // Meeus 1998, eqs. 13.5 and 13.6, with the azimuth from north.
  const double sine = std::sin(latitude) * std::sin(sun.declination) +
                      std::cos(latitude) * std::cos(sun.declination) * std::cos(hour_angle);
  const double east = -std::cos(sun.declination) * std::sin(hour_angle);
  const double north = std::cos(latitude) * std::sin(sun.declination) -
                       std::sin(latitude) * std::cos(sun.declination) * std::cos(hour_angle);
  const double azimuth = std::atan2(east, north) / degree;
  return {std::atan2(sine, std::hypot(east, north)) / degree, azimuth < 0 ? azimuth + 360 : azimuth};
}

Vector direction_to(const SolarPosition& position, const Vector& up, const Vector& north) {
  const double altitude = position.altitude * degree;
  const double azimuth = position.azimuth * degree;
  const Vector east = north.cross(up);
  return std::cos(altitude) * (std::cos(azimuth) * north + std::sin(azimuth) * east) + std::sin(altitude) * up;
}

int day_of_year(const Instant& instant) {
  const Instant new_year{instant.year, 1, 1, 0};
  const Instant noon{instant.year, instant.month, instant.day, 12};
  return static_cast<int>(std::floor(julian_day(noon) - julian_day(new_year))) + 1;
}

}  // namespace patchlight
