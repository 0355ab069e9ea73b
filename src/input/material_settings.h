#pragma once

#include "patchlight/input/read_scene.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace patchlight {

/// The scene with changed materials, one setting after the other. A setting is for the material of that name; without
/// one, for all whose names match it as a pattern, in which * stands for any letters and ? for one, but for second
/// faces of panes, which are made up. \throws InputError at MaterialSetting::where when no material matches, or one
/// that matches is given an index and none has a transmittance.
Scene with_settings(Scene scene, const std::vector<MaterialSetting>& settings);

/// The quantities that can be set, with their names, in the order in which scene files take them. "spectrum" is the
/// spectrum of a light.
inline constexpr std::array<std::pair<const char*, MaterialSetting::Quantity>, 8> named_quantities = {
    {{"reflectance", MaterialSetting::Quantity::reflectance},
     {"specular_reflectance", MaterialSetting::Quantity::specular_reflectance},
     {"transmittance", MaterialSetting::Quantity::transmittance},
     {"diffuse_transmittance", MaterialSetting::Quantity::diffuse_transmittance},
     {"index", MaterialSetting::Quantity::index},
     {"exitance", MaterialSetting::Quantity::exitance},
     {"radiance", MaterialSetting::Quantity::radiance},
     {"spectrum", MaterialSetting::Quantity::light_spectrum}}};

/// True when no value of a setting may be above 1.
bool is_share(MaterialSetting::Quantity quantity);

/// True when a setting of an index of refraction may have this value.
bool is_index(const Spectrum& value);

/// The expected value, for messages.
inline constexpr const char* expected_index = "one number of 1 or more";

/// True when the whole name matches the pattern.
bool matches(std::string_view name, std::string_view pattern);

/// Faces by the names of their object or group, or of their material; patterns with * and ?.
struct FaceChoice {
  std::vector<std::string> only;       ///< nothing else takes part; empty: all
  std::vector<std::string> leave_out;  ///< of these, what does not take part
};

/// The scene with the faces that a choice leaves, and the materials that they have; a note names the rest.
/// \throws InputError at `where`, followed by ".only" or ".leave_out", when a pattern is of no face, or no face is
/// left.
Scene with_chosen_faces(Scene scene, const FaceChoice& choice, const std::string& where);

}  // namespace patchlight
