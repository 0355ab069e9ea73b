#pragma once

#include "patchlight/input/read_scene.h"

#include "input/scene_lights.h"
#include "input/toml/scene_file.h"
#include "input/toml/toml_value.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace patchlight {

/// The parts of the scene file that all tables need.
struct TomlFrame {
  std::filesystem::path file;          ///< the scene file
  std::filesystem::path confine = {};  ///< the folder that must contain all named files; empty: no restriction
  double metres_per_unit = 1;          ///< of its lengths
  Vector up = Vector::UnitZ();         ///< of the scene
};

/// The value as a path; relative paths start at the folder of the scene file. \throws InputError when it lies outside
/// the allowed folder.
std::filesystem::path named_file(const TomlValue& value, const TomlFrame& frame);

/// The tables [[model]]. \throws InputError.
std::vector<ModelEntry> models_of(const TomlValue& root, const TomlFrame& frame);

/// The tables [[material]], with spectra read. \throws InputError.
std::vector<MaterialSetting> settings_of(const TomlValue& root, const TomlFrame& frame);

/// True for a value that is a spectrum by wavelength: a text, or a table.
bool is_by_wavelength(const TomlValue& value);

/// A reflectance or transmittance by wavelength, from a file for read_spectrum(). \throws InputError.
std::shared_ptr<const SampledSpectrum> sampled_share(const TomlValue& value, const TomlFrame& frame);

/// The exitance of a lamp by wavelength, per nm, from such a file. \throws InputError.
std::shared_ptr<const SampledSpectrum> sampled_exitance(const TomlValue& value, const TomlFrame& frame);

/// The relative spectrum of a light: such a file, "D65", "A", {kelvin = 2700} of a black body, or {daylight = 5500}.
/// \throws InputError.
std::shared_ptr<const SampledSpectrum> light_spectrum(const TomlValue& value, const TomlFrame& frame);

/// The CIE daylight of the `color_temperature` in K of a table [sun] or [sky]; null if absent.
/// \throws InputError.
std::shared_ptr<const SampledSpectrum> daylight_of_temperature(const TomlValue& table);

/// The table [spectra]; empty if absent. \throws InputError.
std::optional<BandsAsked> bands_asked(const TomlValue& root);

/// The spectrum files of a scene file.
std::vector<std::filesystem::path> spectrum_files(const TomlValue& root, const TomlFrame& frame);

/// The tables [[luminaire]], one entry for each position, with photometric files read. \throws InputError.
std::vector<LuminaireEntry> luminaires_of(const TomlValue& root, const TomlFrame& frame);

/// True when a luminaire is given in lumens or by a photometric file.
bool in_lumens(const TomlValue& root);

/// All lights of a scene file: luminaires, north, [site], [sun], [sky], [weather] and [ground]. \throws InputError.
LightEntries lights_of(const TomlValue& root, const TomlFrame& frame);

/// The photometric and weather files of a scene file.
std::vector<std::filesystem::path> light_files(const TomlValue& root, const TomlFrame& frame);

}  // namespace patchlight
