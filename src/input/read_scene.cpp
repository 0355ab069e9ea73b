#include "patchlight/input/read_scene.h"

#include "patchlight/base/error.h"

#include "base/words.h"
#include "files/sha256.h"
#include "input/material_settings.h"
#include "input/materials.h"
#include "input/read_model.h"
#include "input/scene_lights.h"
#include "input/text.h"
#include "input/toml/scene_file.h"
#include "input/toml/toml_sensors.h"
#include "light/photometry.h"
#include "scene/extent.h"
#include "scene/less_detail.h"
#include "scene/model_face.h"
#include "scene/photometric_web.h"
#include "scene/repair.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

std::string share_in_words(std::size_t count, std::size_t of, const std::string& noun) {
  return std::to_string(count) + " of " + std::to_string(of) + " " + noun + (of == 1 ? "" : "s");
}

bool has_spectrum(const MaterialSpectra& spectra) {
  return spectra.reflectance || spectra.specular_reflectance || spectra.transmittance || spectra.diffuse_transmittance;
}

// "3 of 5 materials and 1 of 2 lights have spectra"
std::string what_has_spectra(const Scene& scene) {
  const auto materials =
      static_cast<std::size_t>(std::count_if(scene.materials.begin(), scene.materials.end(),
                                             [](const Material& material) { return has_spectrum(material.spectra); }));
  std::size_t lights = 0, with_spectrum = 0;
  for_all_spectra(
      scene, [](const Spectrum&, const SampledSpectrum*) {},
      [&](const Spectrum& values, const SampledSpectrum* spectrum) {
        if (!(values > 0).any()) return;
        ++lights;
        with_spectrum += spectrum ? 1 : 0;
      });
  return share_in_words(materials, scene.materials.size(), "material") + " and " +
         share_in_words(with_spectrum, lights, "light") + " have spectra";
}

std::string bands_in_words(std::size_t number) { return std::to_string(number) + (number == 1 ? " band" : " bands"); }

Scene in_asked_bands(Scene scene, const std::vector<double>& edges_nm) {
  const std::size_t number = edges_nm.size() - 1;
  const std::string has = what_has_spectra(scene);
  const double error = colour_error(scene, edges_nm);
  scene = in_wavelength_bands(std::move(scene), edges_nm);
  scene.band_choice = BandChoice{
      true, has + "; " + bands_in_words(number) + " requested; color errors are at most " + rounded(error, 2) + " dE00",
      "the solution has " + bands_in_words(number) + " instead of 3"};
  return scene;
}

Scene in_needed_bands(Scene scene, double color_error) {
  const std::string has = what_has_spectra(scene);
  const BandsWithError chosen = bands_within(scene, color_error);
  const std::size_t number = chosen.edges_nm.size() - 1;
  scene = with_alike_bands_joined(in_wavelength_bands(std::move(scene), chosen.edges_nm));
  std::string reason = has + "; with " + bands_in_words(number) + " color errors are at most " +
                       rounded(chosen.color_error, 2) + " dE00, the limit is " + shortest(color_error);
  if (scene.bands.size() < number)
    reason += "; equal ones are merged, and " + bands_in_words(scene.bands.size()) + " remain";
  scene.band_choice =
      BandChoice{true, std::move(reason), bands_in_words(scene.bands.size()) + " instead of 400, one for each nm"};
  return scene;
}

// Converts the scene from linear RGB to the requested bands; Scene::band_choice records the reason. Without spectra and
// requested bands nothing changes.
Scene with_bands(Scene scene, const BandsAsked& asked) {
  if (!asked.edges_nm.empty()) return in_asked_bands(std::move(scene), asked.edges_nm);
  if (!has_spectra(scene)) return scene;
  if (!asked.rgb) return in_needed_bands(std::move(scene), asked.color_error);
  const std::string has = what_has_spectra(scene);
  scene = in_rgb(std::move(scene));
  scene.band_choice = BandChoice{false, has + "; linear RGB is requested, which uses only their colors",
                                 "3 bands; colors of light after several reflections may be wrong"};
  return scene;
}

// Moves the vertices, in meters. A reflection reverses the order of corners, so that fronts stay fronts.
Scene placed(Scene scene, const Eigen::Affine3d& placement) {
  for (Point& vertex : scene.vertices) vertex = placement * vertex;
  for (SensorGroup& group : scene.sensors) {
    for (Sensor& sensor : group.sensors) {
      sensor.point = placement * sensor.point;
      sensor.normal = (placement.linear() * sensor.normal).normalized();
    }
  }
  for (Camera& camera : scene.cameras) {
    camera.eye = placement * camera.eye;
    camera.target = placement * camera.target;
  }
  for (NamedRoom& room : scene.rooms)
    for (std::vector<Point>& face : room.faces)
      for (Point& corner : face) corner = placement * corner;
  const auto turn = [&](Vector& direction) { direction = (placement.linear() * direction).normalized(); };
  for (Luminaire& luminaire : scene.luminaires) {
    luminaire.position = placement * luminaire.position;
    turn(luminaire.aim);
    turn(luminaire.zero_plane);
  }
  turn(scene.north);
  if (scene.sun) turn(scene.sun->direction);
  // L x + o = L A^-1 (x' - t) + o for x' = A x + t.
  const Eigen::Matrix3d back = placement.linear().inverse();
  for (TextureMap& map : scene.texture_maps) {
    map.linear = map.linear * back;
    map.offset -= map.linear * placement.translation();
  }
  if (placement.linear().determinant() >= 0) return scene;
  for (Polygon& polygon : scene.polygons) std::reverse(polygon.corners.begin(), polygon.corners.end());
  return scene;
}

Spectrum irradiance_for(double illuminance) { return Spectrum::Constant(1, illuminance / luminous_efficacy); }

// Refuses settings that contradict or require each other.
void require_consistent(const DaylightSetting& setting) {
  if (setting.weather && (setting.sky || setting.sun))
    throw InputError("read.daylight.weather", std::string("cannot be used with ") +
                                                  (setting.sky ? "read.daylight.sky" : "read.daylight.sun") +
                                                  ": a weather file has both sun and sky");
  if (setting.ground_reflectance && !setting.sky && !setting.weather)
    throw InputError("read.daylight.ground",
                     "needs a sky, which lights the ground\nhint: read.daylight.sky=overcast:10000lx");
  const bool needs_sun = setting.sky == SkyKind::cie_clear || setting.sky == SkyKind::perez;
  if (needs_sun && !setting.sun)
    throw InputError("read.daylight.sky",
                     "this sky needs the position of the sun\n"
                     "hint: read.daylight.sun=40,180 or read.daylight.sun=2024-06-21T12:00:00Z@52.5,13.4");
  const bool shapes_only = setting.sun && !(setting.sun_illuminance > 0) && !needs_sun;
  if (shapes_only)
    throw InputError("read.daylight.sun", "direct normal illuminance missing\nhint: read.daylight.sun=40,180:80000lx");
  if (setting.measured && setting.sun_illuminance > 0)
    throw InputError("read.daylight.sun",
                     "this sky already states the illuminance of the sun\nhint: leave it out of read.daylight.sun");
}

SunEntry sun_entry(const DaylightSetting& setting) {
  SunEntry sun;
  sun.position = SolarPosition{setting.sun->altitude, setting.sun->azimuth};
  if (setting.sun_illuminance > 0) sun.normal_irradiance = irradiance_for(setting.sun_illuminance);
  return sun;
}

SkyEntry sky_entry(const DaylightSetting& setting) {
  if (setting.sky != SkyKind::perez) return {*setting.sky, irradiance_for(setting.sky_illuminance), {}, {}};
  SolarIrradiance measured = setting.measured.value_or(SolarIrradiance{});
  measured.day_of_year = setting.sun->day_of_year;
  return {SkyKind::perez, {}, measured, {}};
}

// True when the setting has a sky, a sun or a weather file.
bool asks_for_daylight(const DaylightSetting& setting) {
  return setting.sky || setting.sun || setting.weather || setting.ground_reflectance;
}

// Sun and sky of a setting. The weather file must lie in the folder `confine`, if given. Throws InputError with a field
// of read.daylight, or file and line.
LightEntries lights_of(const DaylightSetting& setting, const std::filesystem::path& confine) {
  require_consistent(setting);
  LightEntries lights;
  lights.photometric = true;
  lights.where = setting.sky ? "read.daylight.sky" : setting.sun ? "read.daylight.sun" : "read.daylight.weather";
  if (setting.weather) {
    require_within(confine, setting.weather->file, "read.daylight.weather");
    lights.weather =
        read_epw(setting.weather->file, setting.weather->month, setting.weather->day, setting.weather->hour);
  }
  if (setting.sun) lights.sun = sun_entry(setting);
  if (setting.sky) lights.sky = sky_entry(setting);
  if (setting.sky || setting.weather) lights.ground_reflectance = setting.ground_reflectance.value_or(0.2);
  return lights;
}

Scene set_upright(Scene scene, const ReadOptions& options) {
  if (options.up || !scene.up_stated) scene.up = options.up ? *options.up : upright_axis(scene);
  scene.up_stated = scene.up_stated || options.up;
  return scene;
}

// The first entry that depends on the vertical axis, e.g. "the sky"; empty if there is none.
std::string upright_part(const LightEntries& lights) {
  const auto hangs_down = [](const LuminaireEntry& entry) {
    const auto& light = entry.luminaire.light;
    return !entry.aim && (std::holds_alternative<WebLight>(light) || std::holds_alternative<SpotLight>(light));
  };
  if (lights.weather) return "the weather";
  if (lights.sky) return "the sky";
  if (lights.sun && !lights.sun->direction) return "the sun";
  const bool has_luminaire = std::any_of(lights.luminaires.begin(), lights.luminaires.end(), hangs_down);
  return has_luminaire ? "the aim of luminaires" : "";
}

std::string upright_part(const DaylightSetting& daylight) {
  if (daylight.weather) return "the weather";
  if (daylight.sky) return "the sky";
  return daylight.sun ? "the sun" : "";
}

std::string upright_part(const ReadOptions& options, const std::vector<SceneFile>& files) {
  std::string part = options.needs_up ? "the weather" : upright_part(options.daylight);
  for (const SceneFile& file : files) {
    if (part.empty()) part = upright_part(file.lights);
    const bool has_grid = std::any_of(file.sensors.begin(), file.sensors.end(),
                                      [](const auto& entry) { return std::holds_alternative<FloorGrid>(entry); });
    if (part.empty() && has_grid) part = "the sensor grid";
  }
  return part;
}

// Adds a problem if `part` of the scene depends on a guessed axis.
Scene with_guess_of_up(Scene scene, const std::string& part) {
  std::erase_if(scene.diagnostics,
                [](const Diagnostic& problem) { return problem.code == DiagnosticCode::guessed_up; });
  if (scene.up_stated || part.empty()) return scene;
  const bool is_y = std::abs(scene.up.y()) > 0.5;
  scene.diagnostics.push_back(
      {DiagnosticCode::guessed_up, std::string("no file states the vertical axis, and ") + part + " depends on it; " +
                                       (is_y ? "y" : "z") + " is a guess by the areas of faces\nhint: read.up=" +
                                       (is_y ? "y" : "z") + " if it is right, else read.up=" + (is_y ? "z" : "y")});
  return scene;
}

// Throws, with the reasons why faces were left out.
[[noreturn]] void refuse_for_lack_of_faces(const Scene& scene) {
  std::string reasons, others;
  for (const Diagnostic& found : scene.diagnostics) {
    if (found.code == DiagnosticCode::zero_area || is_loss(found.code) ||
        found.code == DiagnosticCode::self_intersecting)
      reasons += (reasons.empty() ? "" : "; ") + found.text;
    else if (is_note(found.code))
      others += "; " + found.text;
  }
  if (!reasons.empty()) throw InputError(scene.file, "none of its faces can be used: " + reasons);
  throw InputError(scene.file, "found no faces; expected at least one polygon" + others);
}

SceneFile scene_file(const std::filesystem::path& file, const ReadOptions& options) {
  if (options.metres_per_unit.value_or(1) == 1) {
    require_within(options.confine, file, file.string());
    return read_scene_file(file, options.confine);
  }
  throw InputError("read.metres_per_unit",
                   "cannot be used with a scene file, which states its units with the key unit: " + file.string());
}

FileModel read_entry(const ModelEntry& model, const std::filesystem::path& confine, RadianceModifiers known) {
  require_within(confine, model.file, model.where);
  require_file(model.file, model.where);
  const std::string format = format_of(model.file);
  if (format == "toml") throw InputError(model.where, "a scene file cannot name another one; expected a model file");
  FileModel read = read_model(model.file, format, model.metres_per_unit, confine, std::move(known));
  read.scene = with_chosen_faces(std::move(read.scene), model.choice, model.where + ": model");
  if (model.placement) read.scene = placed(std::move(read.scene), *model.placement);
  return read;
}

// Applies the rest of a scene file to the scene of its models.
Scene with_scene_file(Scene scene, const SceneFile& file) {
  if (scene.files.empty()) scene.files = {scene.file};
  scene.file = file.file;
  scene.sha256 = sha256(std::vector{file.sha256, scene.sha256});
  scene.inputs.insert(scene.inputs.end(), file.inputs.begin(), file.inputs.end());
  scene.metres_per_unit = 1;
  if (file.up) scene.up = *file.up;
  scene.up_stated = scene.up_stated || file.up;
  // If several views share a name, the first one is used.
  scene.cameras.insert(scene.cameras.begin(), file.cameras.begin(), file.cameras.end());
  return with_settings(std::move(scene), file.settings);
}

// Replaces the sun, the sky or both of the files by those of the options, and finds north.
Scene with_daylight(Scene scene, const ReadOptions& options, bool has_north) {
  if (!asks_for_daylight(options.daylight)) return has_north ? scene : with_lights(std::move(scene), {});
  if (options.daylight.weather || options.daylight.sun) scene.sun.reset();
  if (options.daylight.weather || options.daylight.sky) scene.sky.reset();
  LightEntries lights = lights_of(options.daylight, options.confine);
  if (has_north) lights.north = scene.north;
  if (options.daylight.weather) scene.inputs.push_back(options.daylight.weather->file);
  return with_lights(std::move(scene), lights);
}

// Replaces all daylight of the scene by that of the options.
Scene with_other_daylight(Scene scene, const ReadOptions& options) {
  scene.sun.reset();
  scene.sky.reset();
  if (!are_of_wavelengths(bands_of(scene))) return with_daylight(std::move(scene), options, true);
  // Daylight is given in linear RGB, but the materials are already in bands.
  Scene lit;
  lit.file = scene.file;
  lit.up = scene.up;
  lit.north = scene.north;
  lit.materials = {default_material()};
  lit = with_daylight(std::move(lit), options, true);
  scene.photometric = scene.photometric || lit.photometric;
  scene.north = lit.north;
  scene.sun = lit.sun;
  scene.sky = lit.sky;
  scene.inputs.insert(scene.inputs.end(), lit.inputs.begin(), lit.inputs.end());
  scene.diagnostics.insert(scene.diagnostics.end(), lit.diagnostics.begin(), lit.diagnostics.end());
  return with_daylight_in_bands(std::move(scene));
}

bool asks_for_new_light(const ReadOptions& options) {
  return asks_for_daylight(options.daylight) ||
         std::any_of(options.settings.begin(), options.settings.end(), [](const MaterialSetting& setting) {
           const bool is_of_lamp = setting.quantity == MaterialSetting::Quantity::exitance ||
                                   setting.quantity == MaterialSetting::Quantity::radiance;
           return is_of_lamp && (setting.value > 0).any();
         });
}

// Removes details below the requested size and joins coplanar neighbors.
Scene with_fewer_faces(Scene scene, const ReadOptions& options, const std::vector<SceneFile>& files) {
  double detail = options.detail;
  bool keep = options.keep_faces;
  for (const SceneFile& file : files) {
    detail = std::max(detail, file.detail);
    keep = keep || file.keep_faces;
  }
  if (detail > 0) scene = with_less_detail(std::move(scene), detail);
  if (!keep) scene = with_joined_faces(std::move(scene));
  check(scene);
  return scene;
}

// Applies the maintenance factor of EN 12464-1 to lamps and luminaires; daylight does not age.
Scene maintained(Scene scene, const ReadOptions& options, const std::vector<SceneFile>& files) {
  std::optional<double> stated = options.maintenance_factor;
  for (const SceneFile& file : files) {
    if (!stated) stated = file.maintenance_factor;
  }
  if (!stated || *stated == 1) return scene;
  for (Material& material : scene.materials) {
    material.exitance *= *stated;
    if (material.stated_pane) material.stated_pane->matt_exitance *= *stated;
  }
  for (Luminaire& luminaire : scene.luminaires) luminaire = dimmed(std::move(luminaire), *stated);
  scene.diagnostics.push_back(
      {DiagnosticCode::maintenance_factor,
       "maintenance factor " + shortest(*stated) +
           ": lamps and luminaires give that share of the light stated for them, and all results are "
           "maintained values; sun and sky are as stated"});
  return scene;
}

// Bands of the options, else of the last scene file.
BandsAsked bands_for(const ReadOptions& options, const std::vector<SceneFile>& files) {
  if (options.bands) return *options.bands;
  BandsAsked asked;
  for (const SceneFile& file : files) asked = file.bands.value_or(asked);
  return asked;
}

// Adds the sensors of a scene file.
Scene with_sensors(Scene scene, const SceneFile& file) {
  for (const auto& entry : file.sensors) {
    if (const auto* const grid = std::get_if<FloorGrid>(&entry)) {
      FloorSensors found = sensors_over(scene, *grid);
      for (SensorGroup& group : found.groups) scene.sensors.push_back(std::move(group));
      scene.diagnostics = merged({std::move(scene.diagnostics), found.notes});
    } else {
      scene.sensors.push_back(std::get<SensorGroup>(entry));
    }
  }
  return scene;
}

}  // namespace

std::vector<std::string> readable_formats() {
  return {"obj", "ply", "stl", "off", "dae", "ifc", "gltf", "glb", "hbjson", "rad", "xml", "toml"};
}

Scene read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  return read_scene(std::span(&file, 1), options);
}

Scene read_scene(std::span<const std::filesystem::path> files, const ReadOptions& options) {
  assert(options.metres_per_unit.value_or(1) > 0 && !files.empty());
  std::vector<Scene> models;
  std::vector<SceneFile> scene_files;
  RadianceModifiers modifiers;  // of the files read so far
  const auto add = [&](FileModel model) {
    models.push_back(std::move(model.scene));
    modifiers = std::move(model.modifiers);
  };
  for (const std::filesystem::path& file : files) {
    // With a confined folder, messages do not reveal names of other files.
    require_file(file, file.string(), options.confine.empty());
    const std::string format = options.format.empty() ? format_of(file) : options.format;
    if (format == "toml") {
      scene_files.push_back(scene_file(file, options));
      for (const ModelEntry& model : scene_files.back().models) add(read_entry(model, options.confine, modifiers));
    } else {
      add(read_model(file, format, options.metres_per_unit, options.confine, modifiers));
    }
  }
  Scene scene = merge_scenes(std::move(models));
  for (const SceneFile& file : scene_files) scene = with_scene_file(std::move(scene), file);
  scene = with_chosen_faces(std::move(scene), {options.only, options.leave_out}, "read");
  scene = with_settings(std::move(scene), options.settings);
  scene = with_stated_mirrors(with_stated_panes(std::move(scene)));
  scene = repair(std::move(scene));
  if (scene.polygons.empty()) refuse_for_lack_of_faces(scene);
  check(scene);
  scene = with_fewer_faces(std::move(scene), options, scene_files);
  scene = with_guess_of_up(set_upright(std::move(scene), options), upright_part(options, scene_files));
  for (const SceneFile& file : scene_files) scene = with_lights(std::move(scene), file.lights);
  scene = with_daylight(std::move(scene), options, !scene_files.empty());
  for (const SceneFile& file : scene_files) scene = with_sensors(std::move(scene), file);
  scene = with_bands(std::move(scene), bands_for(options, scene_files));
  scene = maintained(std::move(scene), options, scene_files);
  check_limits(scene);
  return scene;
}

Scene with_options(Scene scene, const ReadOptions& options) {
  scene = with_settings(std::move(scene), options.settings);
  check(scene);
  scene = with_guess_of_up(set_upright(std::move(scene), options), upright_part(options.daylight));
  if (asks_for_daylight(options.daylight)) scene = with_other_daylight(std::move(scene), options);
  if (are_of_wavelengths(bands_of(scene)) && asks_for_new_light(options))
    scene.diagnostics.push_back(
        {DiagnosticCode::simplified_light,
         "the spectrum of new light follows from its linear RGB under D65, or is that of the lamp; "
         "reflectances per band stay averaged over the light of the stored solution"});
  check_limits(scene);
  return scene;
}

}  // namespace patchlight
