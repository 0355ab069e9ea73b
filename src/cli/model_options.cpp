#include "cli/model_options.h"

#include "cli/add_option.h"
#include "cli/arguments.h"
#include "cli/parse_value.h"
#include "light/solar_position.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <regex>
#include <tuple>
#include <utility>

namespace patchlight::cli {
namespace {

void add_choice_options(CLI::App& command, ModelOptions& options) {
  add_list(command, "--only", options.only);
  add_list(command, "--exclude", options.leave_out);
  add(command, "--simplify", [&options](const std::string& text) { options.detail = length("--simplify", text); });
  add(command, "--maintenance-factor", [&options](const std::string& text) {
    options.maintenance_factor = text.ends_with('%')
                                     ? share("--maintenance-factor", text)
                                     : number("--maintenance-factor", text, "a number above 0 and up to 1, e.g. 0.8",
                                              [](double x) { return x > 0 && x <= 1; });
    if (*options.maintenance_factor > 1) throw refusal("--maintenance-factor", text, "at most 100%");
  });
  add(command, "--bands", [&options](const std::string& text) { options.bands = text; });
  add(command, "--color-error", [&options](const std::string& text) {
    options.color_error =
        number("--color-error", text, "a color difference above 0", [](double value) { return value > 0; });
  });
  add_flag(command, "--no-merge", [&options] { options.keep_faces = true; });
}

// What --bands and --color-error ask for, if they do.
std::optional<BandsAsked> bands_asked(const ModelOptions& options) {
  if (options.bands.empty() && !options.color_error) return std::nullopt;
  BandsAsked asked;
  if (options.color_error) asked.color_error = *options.color_error;
  if (options.bands.empty() || options.bands == "auto") return asked;
  const std::string expected = "a number of bands from 1 to 400, rgb or auto";
  if (options.color_error) throw refusal("--bands", options.bands, "auto, or no --color-error beside it");
  asked.rgb = options.bands == "rgb";
  if (asked.rgb) return asked;
  const std::optional<double> bands = to_number(options.bands);
  if (!bands || !is_number_of_bands(*bands)) throw refusal("--bands", options.bands, expected);
  asked.edges_nm = equal_edges(static_cast<Eigen::Index>(*bands));
  return asked;
}

// Before and behind the last of a letter; the second is empty without one.
std::pair<std::string, std::string> parted(const std::string& text, char letter) {
  const std::size_t at = text.rfind(letter);
  if (at == std::string::npos) return {text, {}};
  return {text.substr(0, at), text.substr(at + 1)};
}

// An illuminance above 0, e.g. 10000lx or 10000.
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
          illuminance("--sky", strength, "an illuminance in lx after the colon, e.g. overcast:10000lx");
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
                  "a day of the calendar and a time with its offset, e.g. 2024-06-21T12:00:00Z or "
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
        angles(place, "the sun's altitude and its azimuth from north over east, degrees, e.g. 40,180:80000lx");
  } else {
    const auto [latitude, longitude] =
        angles(place, "latitude and longitude in degrees after the @, north and east positive, e.g. 52.5,13.4");
    const Instant when = instant(text.substr(0, at));
    const SolarPosition position = solar_position({latitude, longitude}, when);
    sun = {position.altitude, position.azimuth, day_of_year(when)};
  }
  daylight.sun = sun;
  if (!strength.empty())
    daylight.sun_illuminance = illuminance("--sun", strength, "an illuminance across its rays in lx, e.g. :80000lx");
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
                  "FILE.epw@MONTH-DAY-HOUR, with the hour at which it begins, e.g. city.epw@6-21-12");
  daylight.weather = DaylightSetting::WeatherFile{file, part(1), part(2), part(3)};
}

}  // namespace

void add_file_options(CLI::App& command, ModelOptions& options) {
  add_list(command, "MODEL", options.models);
  add(command, "--format", [&options](const std::string& text) {
    std::vector<std::pair<std::string, std::string>> allowed;
    for (const std::string& format : readable_formats()) allowed.emplace_back(format, format);
    options.format = choice<std::string>("--format", text, allowed);
  });
  add(command, "--unit", [&options](const std::string& text) { options.metres_per_unit = unit_length(text); });
  add_up_option(command, options.up);
  add(command, "--confine", [&options](const std::string& text) {
    if (text.empty()) throw refusal("--confine", text, "the name of a folder");
    options.confine = text;
  });
}

void add_model_options(CLI::App& command, ModelOptions& options) {
  add_file_options(command, options);
  add_set_option(command, options.settings);
  add_choice_options(command, options);
  add_daylight_options(command, options.daylight);
}

void add_up_option(CLI::App& command, std::optional<Vector>& up) {
  add(command, "--up", [&up](const std::string& text) {
    up = choice<Vector>("--up", text, {{"y", Vector::UnitY()}, {"z", Vector::UnitZ()}});
  });
}

void add_set_option(CLI::App& command, std::vector<std::string>& settings) { add_list(command, "--set", settings); }

void add_daylight_options(CLI::App& command, DaylightSetting& daylight) {
  add(command, "--sky", [&daylight](const std::string& text) { take_sky(daylight, text); });
  add(command, "--sun", [&daylight](const std::string& text) { take_sun(daylight, text); });
  add(command, "--ground", [&daylight](const std::string& text) {
    daylight.ground_reflectance =
        number("--ground", text, "0 to 1", [](double value) { return value >= 0 && value <= 1; });
  });
  add(command, "--weather", [&daylight](const std::string& text) { take_weather(daylight, text); });
}

std::vector<std::filesystem::path> model_files(const ModelOptions& options) {
  for (auto model = options.models.begin(); model != options.models.end(); ++model) {
    if (std::find(options.models.begin(), model, *model) == model) continue;
    throw UsageError("MODEL: found '" + *model + "' twice; expected every model once");
  }
  return {options.models.begin(), options.models.end()};
}

ReadOptions read_options(const ModelOptions& options) {
  ReadOptions read;
  read.metres_per_unit = options.metres_per_unit;
  read.format = options.format;
  read.up = options.up;
  read.confine = options.confine;
  read.only = options.only;
  read.leave_out = options.leave_out;
  read.detail = options.detail;
  read.maintenance_factor = options.maintenance_factor;
  read.keep_faces = options.keep_faces;
  read.daylight = options.daylight;
  read.settings = material_settings(options.settings);
  read.bands = bands_asked(options);
  return read;
}

std::vector<MaterialSetting> material_settings(const std::vector<std::string>& texts) {
  std::vector<MaterialSetting> settings;
  for (const std::string& text : texts) settings.push_back(parse_material_setting(text));
  return settings;
}

}  // namespace patchlight::cli
