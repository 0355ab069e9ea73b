#pragma once

#include "patchlight/input/read_scene.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace patchlight {

/// Applies settings to materials, one after another. A setting applies to the material of that name. Otherwise
/// the name is a pattern (* any letters, ? one letter), which second faces of panes never match.
/// \throws InputError at MaterialSetting::where when nothing matches, or an index matches only opaque materials.
Scene with_settings(Scene scene, const std::vector<MaterialSetting>& settings);

/// The quantities that can be set, in the order of scene files. "spectrum" is the spectrum of a light.
inline constexpr std::array<std::pair<const char*, MaterialSetting::Quantity>, 8> named_quantities = {
    {{"reflectance", MaterialSetting::Quantity::reflectance},
     {"specular_reflectance", MaterialSetting::Quantity::specular_reflectance},
     {"transmittance", MaterialSetting::Quantity::transmittance},
     {"diffuse_transmittance", MaterialSetting::Quantity::diffuse_transmittance},
     {"index", MaterialSetting::Quantity::index},
     {"exitance", MaterialSetting::Quantity::exitance},
     {"radiance", MaterialSetting::Quantity::radiance},
     {"spectrum", MaterialSetting::Quantity::light_spectrum}}};

/// True when a setting's values must not exceed 1.
bool is_share(MaterialSetting::Quantity quantity);

/// True when a setting of an index of refraction may have this value.
bool is_index(const Spectrum& value);

/// The expected value, for messages.
inline constexpr const char* expected_index = "one number of 1 or more";

/// True when the whole name matches the pattern.
bool matches(std::string_view name, std::string_view pattern);

/// A choice of faces by names of objects, groups or materials; patterns with * and ?.
struct FaceChoice {
  std::vector<std::string> only;       ///< faces to keep; empty: all
  std::vector<std::string> leave_out;  ///< faces to remove from these
};

/// The scene with the chosen faces and their materials; a note lists the removed faces.
/// \throws InputError at `where` + ".only" or ".leave_out" when a pattern matches no face, or no face remains.
Scene with_chosen_faces(Scene scene, const FaceChoice& choice, const std::string& where);

}  // namespace patchlight
