#include "cli/options.h"

#include "light/solar_position.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <regex>
#include <tuple>

namespace patchlight::cli {
namespace {

double maintenance_factor(const std::string& option, const std::string& text) {
  if (!text.ends_with('%'))
    return number(option, text, "a number above 0 and up to 1, e.g. 0.8", [](double x) { return x > 0 && x <= 1; });
  const double factor = share(option, text);
  if (factor > 1) throw refusal(option, text, "at most 100%");
  return factor;
}

double above_zero(const std::string& option, const std::string& text) {
  return number(option, text, "a color difference above 0", [](double value) { return value > 0; });
}

double from_0_to_1(const std::string& option, const std::string& text) {
  return number(option, text, "0 to 1", [](double value) { return value >= 0 && value <= 1; });
}

void add_choice_options(CLI::App& command, ModelOptions& options) {
  add_list(command, "--only", options.read.only);
  add_list(command, "--exclude", options.read.leave_out);
  add(command, "--simplify", options.read.detail, length);
  add(command, "--maintenance-factor", options.read.maintenance_factor, maintenance_factor);
  add(command, "--bands", [&options](const std::string& text) { options.bands = text; });
  add(command, "--color-error", options.color_error, above_zero);
  add_flag(command, "--no-merge", options.read.keep_faces);
}

// The bands of --bands and --color-error, if any.
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

// The text before and after the last occurrence of a letter; the second part is empty without one.
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

// A date and time with offset, converted to UTC.
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

void add_up_option(CLI::App& command, std::optional<Vector>& up) {
  add_choice<Vector>(command, "--up", up, {{"y", Vector::UnitY()}, {"z", Vector::UnitZ()}});
}

// Materials and daylight, which a model and stored form factors take alike.
void add_setting_options(CLI::App& command, ModelOptions& options) {
  DaylightSetting& daylight = options.read.daylight;
  add_list(command, "--set", options.settings);
  add(command, "--sky", [&daylight](const std::string& text) { take_sky(daylight, text); });
  add(command, "--sun", [&daylight](const std::string& text) { take_sun(daylight, text); });
  add(command, "--ground", daylight.ground_reflectance, from_0_to_1);
  add(command, "--weather", [&daylight](const std::string& text) { take_weather(daylight, text); });
}

void add_effects(CLI::App& command, const std::string& option, const std::vector<Effect>& effects,
                 std::vector<Effect>& chosen) {
  std::vector<std::pair<std::string, Effect>> allowed;
  for (const Effect effect : effects) allowed.emplace_back(name_of(effect), effect);
  option_text(command.get_name(), option);
  const auto take = [option, allowed, &chosen](const std::vector<std::string>& words) {
    for (const std::string& word : words) chosen.push_back(choice<Effect>(option, word, allowed));
  };
  command.add_option_function<std::vector<std::string>>(option, take)->allow_extra_args(false);
}

}  // namespace

void require_model(const ModelOptions& options, const std::string& command, const std::string& rest) {
  if (options.models.empty())
    throw UsageError(command + ": no model given\nhint: patchlight " + command + " MODEL" + rest);
}

void add_file_options(CLI::App& command, ModelOptions& options) {
  std::vector<std::pair<std::string, std::string>> formats;
  for (const std::string& format : readable_formats()) formats.emplace_back(format, format);
  add_list(command, "MODEL", options.models);
  add_choice<std::string>(command, "--format", options.read.format, formats);
  add_choice<double>(command, "--unit", options.read.metres_per_unit, length_units());
  add_up_option(command, options.read.up);
  add_name(command, "--confine", options.read.confine, "the name of a folder");
}

void add_model_options(CLI::App& command, ModelOptions& options) {
  add_file_options(command, options);
  add_choice_options(command, options);
  add_setting_options(command, options);
}

void add_model_options_without_light(CLI::App& command, ModelOptions& options) {
  add_file_options(command, options);
  add_choice_options(command, options);
  add_list(command, "--set", options.settings);
  add(command, "--ground", options.read.daylight.ground_reflectance, from_0_to_1);
}

void add_light_options(CLI::App& command, ModelOptions& options) {
  add_up_option(command, options.read.up);
  add_setting_options(command, options);
}

void take_model(const ModelOptions& options, ModelArguments& arguments) {
  for (auto model = options.models.begin(); model != options.models.end(); ++model) {
    if (std::find(options.models.begin(), model, *model) == model) continue;
    throw UsageError("MODEL: found '" + *model + "' twice; expected every model once");
  }
  arguments.models.assign(options.models.begin(), options.models.end());
  arguments.read = options.read;
  for (const std::string& text : options.settings) arguments.read.settings.push_back(parse_material_setting(text));
  arguments.read.bands = bands_asked(options);
}

void take_model(const ModelOptions& options, RunArguments& arguments) {
  take_model(options, static_cast<ModelArguments&>(arguments));
  std::optional<double>& max_edge = arguments.request.mesh.max_edge;
  if (max_edge && !options.max_edge_in_metres) *max_edge *= options.read.metres_per_unit.value_or(1);
}

void add_patch_options(CLI::App& command, ModelOptions& options, Request& request) {
  add(command, "--max-edge", [&options, &request](const std::string& text) {
    options.max_edge_in_metres = !to_number(text);
    request.mesh.max_edge = length("--max-edge", text);
  });
  add_whole(command, "--patches", request.mesh.patches, 1, 1'000'000'000);
  add_flag(command, "--no-contact-lines", request.mesh.contact_lines, false);
}

void add_graded_option(CLI::App& command, Request& request) {
  add_flag(command, "--graded-edges", request.mesh.graded_edges);
}

void add_refinement_options(CLI::App& command, Request& request) {
  CLI::Option* const error = add(command, "--accuracy", request.accuracy.relative_error, relative_error);
  CLI::Option* const time = add(command, "--time-limit", request.accuracy.seconds, seconds);
  add_list(command, "--focus", request.accuracy.interest);
  request.accuracy.local_cuts = true;
  add_flag(command, "--no-refine", request.accuracy.local_cuts, false)->excludes(error)->excludes(time);
}

void add_accuracy_options(CLI::App& command, Request& request) {
  add_refinement_options(command, request);
  request.accuracy.cheap_error_bars = true;
  CLI::Option* const bars = add_flag(command, "--error-bars", request.accuracy.error_bars);
  add_flag(command, "--no-error-bars", request.accuracy.cheap_error_bars, false)->excludes(bars);
}

void add_method_options(CLI::App& command, Request& request, bool stored) {
  std::vector<std::pair<std::string, Storage>> methods = {{"pairs", Storage::tiles}, {"rays", Storage::rays}};
  if (!stored) {
    methods.insert(methods.begin(), {"auto", Storage::automatic});
    methods.emplace_back("on-demand", Storage::on_demand);
  }
  add_choice<Storage>(command, "--method", request.assembly.storage, methods);
  add(command, "--rays", [&request](const std::string& text) {
    request.assembly.rays = static_cast<int>(whole_number("--rays", text, 16, 4096));
    if (request.assembly.storage == Storage::automatic) request.assembly.storage = Storage::rays;
  });
}

void add_run_options(CLI::App& command, ModelOptions& options, Request& request, const std::vector<Effect>& effects) {
  add_model_options(command, options);
  add_sides_option(command, request.mesh.sides);
  add_effect_options(command, request, effects);
  add_patch_options(command, options, request);
  add_sampling_options(command, request);
  add_machine_options(command, request);
}

Request with_fitting_solver(Request request, bool solver_given) {
  Storage& storage = request.assembly.storage;
  if (solver_given) {
    const Solver solver = request.solver.solver;
    if (storage == Storage::automatic && (takes_rows(solver) || takes_reciprocity(solver))) storage = Storage::tiles;
  } else if (storage == Storage::rays) {
    request.solver.solver = Solver::gmres;
  } else if (storage == Storage::on_demand) {
    request.solver.solver = Solver::progressive;
  }
  return request;
}

void add_closure_option(CLI::App& command, Request& request) {
  add_flag(command, "--no-closure", request.assembly.close, false);
}

void add_relaxation_option(CLI::App& command, std::optional<double>& relaxation) {
  add(command, "--relaxation", relaxation, [](const std::string& option, const std::string& text) {
    return number(option, text, "a number above 0 and below 2", [](double x) { return x > 0 && x < 2; });
  });
}

void add_sampling_options(CLI::App& command, Request& request) {
  add_whole(command, "--samples", request.assembly.samples, 4, 16384);
  add_choice<Estimator>(command, "--estimator", request.assembly.estimator,
                        {{"auto", Estimator::automatic},
                         {"area", Estimator::area},
                         {"point-polygon", Estimator::point_polygon},
                         {"hemisphere", Estimator::hemisphere},
                         {"contour", Estimator::contour}});
  add_whole(command, "--seed", request.assembly.seed, 0, ~std::uint64_t{0});
}

std::vector<Effect> effects_but(const std::vector<Effect>& without) {
  std::vector<Effect> effects = simulated_effects();
  std::erase_if(effects, [&](Effect effect) { return effect == Effect::closure || contains(without, effect); });
  return effects;
}

void add_effect_options(CLI::App& command, Request& request, const std::vector<Effect>& effects) {
  add_effects(command, "--enable", effects, request.effects.force);
  add_effects(command, "--disable", effects, request.effects.skip);
}

void add_threads_option(CLI::App& command, int& threads) { add_whole(command, "--threads", threads, 0, 1024); }

void add_machine_options(CLI::App& command, Request& request) {
  add_threads_option(command, request.resources.threads);
  add(command, "--memory", request.resources.memory, bytes);
}

void add_quiet_option(CLI::App& command, bool& quiet) { add_flag(command, "-q,--quiet", quiet); }

}  // namespace patchlight::cli
