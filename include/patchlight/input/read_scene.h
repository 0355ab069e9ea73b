#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// A change to one material, applied after reading: "light.radiance=17,12,4".
struct MaterialSetting {
  enum class Quantity { reflectance, exitance, radiance };
  std::string material;
  Quantity quantity = Quantity::reflectance;
  Spectrum value;  ///< one value stands for all bands
};

/// Parses MATERIAL.reflectance=R,G,B (or one value for all bands), .exitance= or .radiance=.
/// \throws InputError naming the option --set.
MaterialSetting parse_material_setting(const std::string& text);

struct ReadOptions {
  double metres_per_unit = 1;     ///< length of one model unit
  std::optional<Vector> up = {};  ///< if not given, upright_axis() of the scene
  std::vector<MaterialSetting> settings = {};
};

/// Reads a model; the format follows from the extension (.obj). Lengths are converted to metres, Ke (emitted radiance)
/// to exitance = pi Ke. What is read but not simulated is named in Scene::notes. docs/formats.md has the details.
/// \throws InputError when the file is missing, unreadable or unusable.
Scene read_scene(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace patchlight
