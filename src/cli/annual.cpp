// The command that computes a year of daylight.
#include "patchlight/annual/annual.h"

#include "patchlight/annual/metrics.h"
#include "patchlight/base/error.h"

#include "archive/annual_files.h"
#include "base/parallel.h"
#include "base/words.h"
#include "cli/commands.h"
#include "cli/distinct_files.h"
#include "cli/messages.h"
#include "cli/option_names.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/summary.h"
#include "input/tables/read_tables.h"
#include "light/photometry.h"
#include "plan/check_request.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <regex>
#include <sstream>

namespace patchlight::cli {
namespace {

void take_hours(AnnualArguments& arguments, const std::string& text) {
  static const std::regex form(R"((\d{1,2})-(\d{1,2}))");
  std::smatch found;
  if (std::regex_match(text, found, form)) {
    arguments.first_hour = std::stoi(found[1]);
    arguments.last_hour = std::stoi(found[2]);
    if (arguments.first_hour < arguments.last_hour && arguments.last_hour <= 24) return;
  }
  throw refusal("--hours", text, "two hours from 0 to 24, the first below the second, e.g. 8-18");
}

AnnualArguments finish_annual(const GivenOptions<AnnualArguments>& given) {
  AnnualArguments arguments = given.arguments;
  take_model(given.model, arguments);
  if (arguments.models.empty() || arguments.output.empty())
    throw UsageError(std::string("annual: no ") + (arguments.models.empty() ? "model" : "-o FOLDER") +
                     " given\nhint: patchlight annual MODEL --weather FILE.epw -o FOLDER");
  arguments.request = with_fitting_solver(std::move(arguments.request), false);
  check(arguments.request);
  return arguments;
}

bool is_weather(const std::filesystem::path& file) { return file.extension() == ".epw" || file.extension() == ".EPW"; }

// The named file, else that of the scene file. Throws InputError without any.
std::filesystem::path weather_file(const AnnualArguments& arguments, const Scene& scene) {
  if (!arguments.weather.empty()) return arguments.weather;
  const auto found = std::find_if(scene.inputs.begin(), scene.inputs.end(), is_weather);
  if (found != scene.inputs.end()) return *found;
  throw InputError("--weather", "the scene file names no weather file\nhint: --weather FILE.epw");
}

// The named one, else that of the scene's sky, L = rho E / pi, else the default of --weather.
double ground_reflectance(const AnnualArguments& arguments, const Scene& scene) {
  if (arguments.read.daylight.ground_reflectance) return *arguments.read.daylight.ground_reflectance;
  constexpr double usual = 0.2;
  if (!arguments.weather.empty() || !scene.sky || scene.sky->horizontal_irradiance.size() == 0) return usual;
  const Spectrum on_ground = irradiance_of_ground({scene.sun, scene.sky}, scene.up, number_of_bands(scene));
  if (scene.sky->ground_radiance.size() == 0 || !(on_ground.mean() > 0)) return usual;
  return std::numbers::pi * scene.sky->ground_radiance.mean() / on_ground.mean();
}

Scene scene_with_sensors(const AnnualArguments& arguments, const Observer& observer) {
  ReadOptions read = arguments.read;
  read.daylight.ground_reflectance.reset();
  read.needs_up = true;
  Scene scene = read_models(arguments.models, read, observer);
  if (!arguments.points.empty()) scene.sensors.push_back(read_points(arguments.points, scene.metres_per_unit));
  if (all_sensors(scene.sensors).empty())
    throw InputError(scene.file,
                     "has no sensors, at which a year could be computed\n"
                     "hint: --points FILE, or patchlight init MODEL -o SCENE.toml");
  return scene;
}

std::vector<HourRow> hour_rows(const WeatherYear& weather, const Year& year, const Scene& scene,
                               const CountedHours& counted) {
  const Bands bands = bands_of(scene);
  std::vector<HourRow> rows;
  for (std::size_t k = 0; k < weather.hours.size(); ++k) {
    const WeatherHour& hour = weather.hours[k];
    const SolarPosition sun = solar_position(hour.place, hour.middle);
    const Daylight& light = year.hours[k];
    rows.push_back({.month = hour.middle.month,
                    .day = hour.middle.day,
                    .hour = static_cast<int>(k % 24),
                    .sun_altitude = sun.altitude,
                    .sun_azimuth = sun.azimuth,
                    .direct_normal = hour.solar.direct_normal,
                    .diffuse_horizontal = hour.solar.diffuse_horizontal,
                    .direct_normal_lux = light.sun ? luminance(light.sun->normal_irradiance, bands) : 0,
                    .diffuse_horizontal_lux = light.sky ? luminance(light.sky->horizontal_irradiance, bands) : 0,
                    .is_occupied = counted.occupied[k] != 0});
  }
  return rows;
}

std::string with_error(const Measure& measure, int digits) {
  return rounded(measure.value, digits) + " +- " + rounded(measure.standard_error, 2);
}

std::string summary(const AnnualMetrics& metrics) {
  std::vector<TextRow> rows{
      {"room", "sensors", "sDA300/50 %", "ASE1000/250 %", "DA300 %", "UDI 300-3000 %", "mean lx", "EN 17037"}};
  constexpr std::array<const char*, 4> grades = {"none", "minimum", "medium", "high"};
  const auto add = [&](const RoomYear& room) {
    const auto of = [&](RoomMeasure m) { return room.measures[static_cast<std::size_t>(m)]; };
    const double grade = of(RoomMeasure::grade).value;
    rows.push_back({shown_name(room.name), std::to_string(room.sensors),
                    with_error(of(RoomMeasure::spatial_autonomy), 3), with_error(of(RoomMeasure::sunlight_exposure), 3),
                    with_error(of(RoomMeasure::mean_autonomy), 3), with_error(of(RoomMeasure::mean_udi_300_to_3000), 3),
                    with_error(of(RoomMeasure::mean_illuminance), 4),
                    grade >= 0 ? grades[static_cast<std::size_t>(grade)] : "-"});
  };
  for (std::size_t k = 0; k < std::min<std::size_t>(20, metrics.rooms.size()); ++k) add(metrics.rooms[k]);
  if (metrics.rooms.size() > 20) rows.push_back({"...", "", "", "", "", "", "", ""});
  if (metrics.rooms.size() > 1) add(metrics.building);
  return text_table(rows);
}

std::string costs(const AnnualLight& light) {
  std::ostringstream text;
  double all = 0;
  text << "CPU seconds:";
  for (const PhaseCost& cost : light.costs) {
    all += cost.cpu_seconds;
    text << ' ' << cost.phase << ' ' << rounded(cost.cpu_seconds, 2) << ';';
  }
  text << " all " << rounded(all, 3) << '\n';
  return text.str();
}

// Warns of results that may be wrong.
ExitCode exit_code_of(const AnnualLight& light) {
  if (light.converged && light.is_accurate) return good;
  if (!light.converged)
    print_message("warning", "the solver has not converged: light that is reflected often is missing");
  else
    print_message("warning",
                  "the requested accuracy was not reached under the overcast sky\nhint: more time or memory");
  return not_converged;
}

}  // namespace

Finish add_annual(CLI::App& tool) {
  auto to = std::make_shared<GivenOptions<AnnualArguments>>();
  CLI::App& command = *tool.add_subcommand("annual");
  AnnualArguments& arguments = to->arguments;
  Request& request = arguments.request;
  add_model_options_without_light(command, to->model);
  add_name(command, "--weather", arguments.weather, "the name of an EPW file");
  add(command, "--hours", [&arguments](const std::string& text) { take_hours(arguments, text); });
  add_choice<int>(command, "--sky-division", arguments.options.sky_division, {{"1", 1}, {"2", 2}, {"4", 4}});
  add_name(command, "-o,--output", arguments.output, "the name of a folder");
  add_name(command, "--points", arguments.points, "the name of a file");
  add_sides_option(command, request.mesh.sides);
  add_patch_options(command, to->model, request);
  add_accuracy_options(command, request);
  add_method_options(command, request, true);
  add_effect_options(command, request, effects_but({Effect::sun, Effect::luminaires, Effect::sky}));
  add_sampling_options(command, request);
  add_machine_options(command, request);
  add_quiet_option(command, arguments.quiet);
  return [to] { return finish_annual(*to); };
}

ExitCode run(const AnnualArguments& arguments) {
  check_annual_writable(arguments.output);
  const ThreadLimit limit(arguments.request.resources.threads);
  ProgressLine line(progress_shown(arguments.quiet));
  const Observer observer = observer_on(line);

  // 1. Read the scene and the weather
  const Scene scene = scene_with_sensors(arguments, observer);
  const WeatherYear weather = read_epw_year(weather_file(arguments, scene));
  require_not_read_from({"-o", arguments.output}, scene.inputs);
  const Year year = daylight_of(weather, scene, ground_reflectance(arguments, scene));

  // 2. Compute the year; as stages come several times, progress is that of each
  const AnnualLight light = simulate_year(scene, year, arguments.request, arguments.options, observer);
  const CountedHours counted = counted_hours(year, scene, arguments.first_hour, arguments.last_hour);
  const AnnualMetrics metrics = metrics_of(light, scene.sensors, counted);

  // 3. Write it
  const std::vector<HourRow> hours = hour_rows(weather, year, scene, counted);
  {
    const WritingGuard guard;
    write_annual(arguments.output, {light, metrics, scene.sensors, hours, weather.file, arguments.first_hour,
                                    arguments.last_hour, arguments.options.sky_division, arguments.command_line});
  }
  line.hide();
  for (const Diagnostic& warning : light.warnings) print_diagnostic("warning", warning);
  const ExitCode code = exit_code_of(light);
  print_notes(merged({weather.notes, light.notes}), arguments.quiet);
  if (!arguments.quiet)
    std::cout << summary(metrics) << costs(light) << "wrote " << shown_name(arguments.output.string()) << std::endl;
  return code;
}

}  // namespace patchlight::cli
