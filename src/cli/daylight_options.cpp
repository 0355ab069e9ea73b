#include "cli/daylight_options.h"

#include "cli/add_option.h"
#include "cli/parse_value.h"
#include "light/solar_position.h"

#include <chrono>
#include <cmath>
#include <regex>
#include <tuple>

namespace patchlight::cli {
namespace {

// Before and behind the last of a letter; the second is empty without one.
std::pair<std::string, std::string> parted(const std::string& text, char letter) {
  const std::size_t at = text.rfind(letter);
  if (at == std::string::npos) return {text, {}};
  return {text.substr(0, at), text.substr(at + 1)};
}

// An illuminance above 0, as 10000lx or 10000.
double illuminance(const std::string& option, const std::string& text, const std::string& expected) {
  const std::string value = text.ends_with("lx") ? text.substr(0, text.size() - 2) : text;
  return number(option, value, expected, [](double lux) { return lux > 0; });
}

void take_sky(DaylightSetting& daylight, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string strength = colon == std::string::npos ? "" : text.substr(colon + 1);
  daylight.sky = choice<SkyKind>("--sky", text.substr(0, colon),
                                 {{"overcast", SkyKind::cie_overcast},
                                  {"uniform", SkyKind::uniform},
                                  {"clear", SkyKind::cie_clear},
                                  {"perez", SkyKind::perez}});
  if (daylight.sky != SkyKind::perez) {
    if (colon != std::string::npos)
      daylight.sky_illuminance =
          illuminance("--sky", strength, "an illuminance in lx after the colon, as in overcast:10000lx");
    return;
  }
  const std::string expected = "perez:DIRECT,DIFFUSE, the direct normal and the diffuse horizontal irradiance in W/m^2";
  const std::vector<std::string> values = split(strength);
  if (values.size() != 2) throw refusal("--sky", text, expected);
  const auto irradiance = [&](const std::string& value) {
    return number("--sky", value, expected, [](double watts) { return watts >= 0; });
  };
  daylight.measured = SolarIrradiance{irradiance(values[0]), irradiance(values[1])};
}

// A date and time with its offset, in UTC.
Instant instant(const std::string& text) {
  static const std::regex form(R"((\d{4})-(\d{2})-(\d{2})[T ](\d{2}):(\d{2})(?::(\d{2}))?(?:Z|([+-])(\d{2}):(\d{2})))");
  std::smatch found;
  const bool matches = std::regex_match(text, found, form);
  const auto part = [&](std::size_t k) { return found[k].matched ? std::stoi(found[k]) : 0; };
  const std::chrono::year_month_day day(std::chrono::year(part(1)), std::chrono::month(static_cast<unsigned>(part(2))),
                                        std::chrono::day(static_cast<unsigned>(part(3))));
  if (!matches || !day.ok() || part(4) > 23 || part(5) > 59 || part(6) > 59 || part(8) > 14 || part(9) > 59)
    throw refusal("--sun", text,
                  "a day of the calendar and a time with its offset, as 2024-06-21T12:00:00Z or "
                  "2024-06-21T13:00+01:00, before the @");
  const double minutes_east = (found[7].str() == "-" ? -1 : 1) * (60 * part(8) + part(9));
  return {part(1), part(2), part(3), part(4) + (part(5) - minutes_east) / 60.0 + part(6) / 3600.0};
}

// Two angles in degrees, the first from -90 to 90, the second from -360 to 360.
std::pair<double, double> angles(const std::string& text, const std::string& expected) {
  const std::vector<std::string> values = split(text);
  if (values.size() != 2) throw refusal("--sun", text, expected);
  const auto angle = [&](const std::string& value, double largest) {
    return number("--sun", value, expected, [largest](double degrees) { return std::abs(degrees) <= largest; });
  };
  return {angle(values[0], 90), angle(values[1], 360)};
}

void take_sun(DaylightSetting& daylight, const std::string& text) {
  const std::size_t at = text.find('@');
  const auto [place, strength] = [&]() -> std::pair<std::string, std::string> {
    const std::string rest = at == std::string::npos ? text : text.substr(at + 1);
    return parted(rest, ':');
  }();
  DaylightSetting::SunPlace sun;
  if (at == std::string::npos) {
    std::tie(sun.altitude, sun.azimuth) =
        angles(place, "the sun's altitude and its azimuth from north over east, degrees, as in 40,180:80000lx");
  } else {
    const auto [latitude, longitude] =
        angles(place, "latitude and longitude in degrees after the @, north and east positive, as in 52.5,13.4");
    const Instant when = instant(text.substr(0, at));
    const SolarPosition position = solar_position({latitude, longitude}, when);
    sun = {position.altitude, position.azimuth, day_of_year(when)};
  }
  daylight.sun = sun;
  if (!strength.empty())
    daylight.sun_illuminance = illuminance("--sun", strength, "an illuminance across its rays in lx, as in :80000lx");
}

void take_weather(DaylightSetting& daylight, const std::string& text) {
  const auto [file, when] = parted(text, '@');
  static const std::regex form(R"((\d{1,2})-(\d{1,2})-(\d{1,2}))");
  std::smatch found;
  const bool matches = std::regex_match(when, found, form);
  const auto part = [&](std::size_t k) { return matches ? std::stoi(found[k]) : -1; };
  const bool is_hour = part(1) >= 1 && part(1) <= 12 && part(2) >= 1 && part(2) <= 31 && part(3) >= 0 && part(3) <= 23;
  if (file.empty() || !is_hour)
    throw refusal("--weather", text,
                  "FILE.epw@MONTH-DAY-HOUR, with the hour at which it begins, as in city.epw@6-21-12");
  daylight.weather = DaylightSetting::WeatherFile{file, part(1), part(2), part(3)};
}

}  // namespace

void add_daylight_options(CLI::App& command, DaylightSetting& daylight) {
  command.option_defaults()->group("Daylight");
  add(command, "--sky", "KIND[:STRENGTH]",
      "the sky: overcast, uniform or clear (this with --sun) and the\nilluminance of the open ground by it, as in "
      "overcast:10000lx,\nwhich is the default; or perez:DIRECT,DIFFUSE, as measured in\nW/m^2; default: none, or what "
      "the scene "
      "file has",
      [&daylight](const std::string& text) { take_sky(daylight, text); });
  add(command, "--sun", "PLACE[:LX]",
      "where the sun stands, as ALTITUDE,AZIMUTH in degrees, the second\nfrom north over east, or "
      "TIME@LATITUDE,LONGITUDE, "
      "and how strong\nit is across its rays: 40,180:80000lx,\n2024-06-21T12:00:00Z@52.5,13.4:80000lx; with a clear "
      "sky "
      "and\nwithout a strength it only shapes the sky; default: none, or what\nthe scene file has",
      [&daylight](const std::string& text) { take_sun(daylight, text); });
  add(command, "--ground", "R", "reflectance of the ground below the horizon, 0 to 1; default: 0.2",
      [&daylight](const std::string& text) {
        daylight.ground_reflectance =
            number("--ground", text, "0 to 1", [](double value) { return value >= 0 && value <= 1; });
      });
  add(command, "--weather", "FILE@HOUR",
      "sun and sky of an hour of an EPW file, which begins at\nMONTH-DAY-HOUR, standard time: city.epw@6-21-12; "
      "default: none, or\nwhat the scene file has",
      [&daylight](const std::string& text) { take_weather(daylight, text); });
}

}  // namespace patchlight::cli
