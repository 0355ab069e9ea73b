#include "cli/options.h"

#include "base/rounded.h"
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

void add_rays_option(CLI::App& command, Request& request) {
  add(command, "--rays", [&request](const std::string& text) {
    request.assembly.rays = static_cast<int>(whole_number("--rays", text, 16, 4096));
    if (request.assembly.storage == Storage::automatic) request.assembly.storage = Storage::rays;
  });
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

Request in_metres(const RequestGiven& given, double metres_per_unit) {
  Request request = given;
  if (request.mesh.max_edge && !given.max_edge_in_metres) *request.mesh.max_edge *= metres_per_unit;
  return request;
}

void add_sides_option(CLI::App& command, Request& request) {
  add(command, "--sides", [&request](const std::string& text) { request.mesh.sides = sides_named(text); });
}

Sides sides_named(const std::string& text) {
  return choice<Sides>("--sides", text, {{"auto", Sides::automatic}, {"front", Sides::front}, {"both", Sides::both}});
}

void add_patch_options(CLI::App& command, RequestGiven& request) {
  add(command, "--max-edge", [&request](const std::string& text) {
    request.max_edge_in_metres = !to_number(text);
    request.mesh.max_edge = length("--max-edge", text);
  });
  add(command, "--patches", [&request](const std::string& text) {
    request.mesh.patches = whole_number("--patches", text, 1, 1'000'000'000);
  });
  add_flag(command, "--no-contact-lines", [&request] { request.mesh.contact_lines = false; });
}

void add_graded_option(CLI::App& command, Request& request) {
  add_flag(command, "--graded-edges", [&request] { request.mesh.graded_edges = true; });
}

void add_refinement_options(CLI::App& command, Request& request) {
  CLI::Option* const error = add(command, "--accuracy", [&request](const std::string& text) {
    request.accuracy.relative_error = relative_error("--accuracy", text);
  });
  CLI::Option* const time = add(command, "--time-limit", [&request](const std::string& text) {
    request.accuracy.seconds = seconds("--time-limit", text);
  });
  add_list(command, "--focus", request.accuracy.interest);
  request.accuracy.local_cuts = true;
  add_flag(command, "--no-refine", [&request] { request.accuracy.local_cuts = false; })
      ->excludes(error)
      ->excludes(time);
}

void add_accuracy_options(CLI::App& command, Request& request) {
  add_refinement_options(command, request);
  request.accuracy.cheap_error_bars = true;
  CLI::Option* const bars = add_flag(command, "--error-bars", [&request] { request.accuracy.error_bars = true; });
  add_flag(command, "--no-error-bars", [&request] { request.accuracy.cheap_error_bars = false; })->excludes(bars);
}

std::optional<std::string> note_on_accuracy(const Request& request) {
  if (!request.accuracy.relative_error) return std::nullopt;
  return "refining until the estimated error of mesh, form factors and solver is below " +
         percent(*request.accuracy.relative_error, 4) + " %";
}

void add_method_options(CLI::App& command, Request& request) {
  add(command, "--method", [&request](const std::string& text) {
    request.assembly.storage = choice<Storage>("--method", text,
                                               {{"auto", Storage::automatic},
                                                {"pairs", Storage::tiles},
                                                {"rays", Storage::rays},
                                                {"on-demand", Storage::on_demand}});
  });
  add_rays_option(command, request);
}

void add_stored_method_options(CLI::App& command, Request& request) {
  add(command, "--method", [&request](const std::string& text) {
    request.assembly.storage = choice<Storage>("--method", text, {{"pairs", Storage::tiles}, {"rays", Storage::rays}});
  });
  add_rays_option(command, request);
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
  add_flag(command, "--no-closure", [&request] { request.assembly.close = false; });
}

void add_relaxation_option(CLI::App& command, std::optional<double>& relaxation) {
  add(command, "--relaxation", [&relaxation](const std::string& text) {
    const auto inside = [](double x) { return x > 0 && x < 2; };
    relaxation = number("--relaxation", text, "a number above 0 and below 2", inside);
  });
}

void add_tolerance_option(CLI::App& command, double least, const std::function<void(double)>& take) {
  add(command, "--tolerance", [take, least](const std::string& text) {
    const auto inside = [least](double x) { return x > 0 && x >= least && x < 1; };
    const std::string lower = least > 0 ? "from " + rounded(least) + " to" : "above 0 and";
    take(number("--tolerance", text, "a number " + lower + " below 1", inside));
  });
}

void add_sampling_options(CLI::App& command, Request& request) {
  add(command, "--samples", [&request](const std::string& text) {
    request.assembly.samples = static_cast<int>(whole_number("--samples", text, 4, 16384));
  });
  add(command, "--estimator", [&request](const std::string& text) {
    request.assembly.estimator = choice<Estimator>("--estimator", text,
                                                   {{"auto", Estimator::automatic},
                                                    {"area", Estimator::area},
                                                    {"point-polygon", Estimator::point_polygon},
                                                    {"hemisphere", Estimator::hemisphere},
                                                    {"contour", Estimator::contour}});
  });
  add(command, "--seed", [&request](const std::string& text) {
    request.assembly.seed = whole_number("--seed", text, 0, ~std::uint64_t{0});
  });
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

void add_threads_option(CLI::App& command, int& threads) {
  add(command, "--threads",
      [&threads](const std::string& text) { threads = static_cast<int>(whole_number("--threads", text, 0, 1024)); });
}

void add_machine_options(CLI::App& command, Request& request) {
  add_threads_option(command, request.resources.threads);
  add(command, "--memory", [&request](const std::string& text) { request.resources.memory = bytes("--memory", text); });
}

void add_quiet_option(CLI::App& command, bool& quiet) {
  add_flag(command, "-q,--quiet", [&quiet] { quiet = true; });
}

}  // namespace patchlight::cli
