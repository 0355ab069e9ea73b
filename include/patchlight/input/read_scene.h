#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// A change to materials, applied after reading: "light.radiance=17,12,4".
struct MaterialSetting {
  enum class Quantity {
    reflectance,
    exitance,
    radiance,
    transmittance,
    index,
    specular_reflectance,
    diffuse_transmittance
  };
  std::string material;  ///< a name, or a pattern with * for any letters and ? for one
  Quantity quantity = Quantity::reflectance;
  Spectrum value;                       ///< one value stands for all bands; an index has one
  std::string where = "read.settings";  ///< where it is asked for, for messages
};

/// Parses MATERIAL.reflectance=R,G,B (or one value for all bands), .exitance=, .radiance=, .transmittance=,
/// .diffuse_transmittance=, .specular_reflectance=, or .index= with one value.
/// \throws InputError naming read.settings.
MaterialSetting parse_material_setting(const std::string& text);

/// How a model file is to be taken.
struct ReadOptions {
  double metres_per_unit = 1;     ///< length of one model unit; with formats that state their unit, a further factor
  std::optional<Vector> up = {};  ///< if not given, what the file says, else upright_axis() of the scene
  std::vector<MaterialSetting> settings = {};
  std::filesystem::path confine = {};  ///< a folder outside of which nothing is read; if empty, any file may be
  std::string format = {};             ///< an extension without its dot; if empty, that of the file
};

/// The extensions of the formats that can be read, without dots.
std::vector<std::string> readable_formats();

/// Reads a model or a scene file (.toml, which names models, sensors and more); the format follows from the extension,
/// and "-" stands for the standard input, which is OBJ unless options.format says otherwise. Lengths are converted to
/// metres, emitted radiance L to exitance = pi L. What is read but not simulated is named in Scene::notes.
/// docs/formats.md has the details.
/// \throws InputError when the file is missing, unreadable or unusable.
Scene read_scene(const std::filesystem::path& file, const ReadOptions& options = {});

/// A scene that was read before, with the settings and the upright axis of these options. \throws InputError when no
/// material bears the name of a setting, or settings make a material that check() refuses.
Scene with_options(Scene scene, const ReadOptions& options);

/// Reads several models as one scene. Materials with the same name and values become one; those that only share the
/// name are kept apart, and a note says so. \throws InputError as for one file.
Scene read_scene(std::span<const std::filesystem::path> files, const ReadOptions& options = {});

}  // namespace patchlight
