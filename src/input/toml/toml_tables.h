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

/// The scene file around the tables [[model]].
struct TomlFrame {
  std::filesystem::path file;          ///< the scene file
  std::filesystem::path confine = {};  ///< the folder in which the files that it names must lie; empty for any
  double metres_per_unit = 1;          ///< of its lengths
  Vector up = Vector::UnitZ();         ///< of the scene
};

/// The value as a path; relative ones start from the folder of the scene file. \throws InputError when it does not lie
/// in the folder that the frame allows.
std::filesystem::path named_file(const TomlValue& value, const TomlFrame& frame);

/// The tables [[model]]. \throws InputError.
std::vector<ModelEntry> models_of(const TomlValue& root, const TomlFrame& frame);

/// The tables [[material]]; the spectra that they name are read. \throws InputError.
std::vector<MaterialSetting> settings_of(const TomlValue& root, const TomlFrame& frame);

/// True for a value that stands for a spectrum by wavelength: a text, or a table.
bool is_by_wavelength(const TomlValue& value);

/// A reflectance or transmittance by wavelength: a file that read_spectrum() reads. \throws InputError.
std::shared_ptr<const SampledSpectrum> sampled_share(const TomlValue& value, const TomlFrame& frame);

/// The exitance of a lamp by wavelength, per nm: such a file. \throws InputError.
std::shared_ptr<const SampledSpectrum> sampled_exitance(const TomlValue& value, const TomlFrame& frame);

/// How light is spread: such a file, "D65", "A", {kelvin = 2700} of a black body, or {daylight = 5500}. \throws
/// InputError.
std::shared_ptr<const SampledSpectrum> light_spectrum(const TomlValue& value, const TomlFrame& frame);

/// The CIE daylight of a `color_temperature` in K that a table [sun] or [sky] names; null where it names none.
/// \throws InputError.
std::shared_ptr<const SampledSpectrum> daylight_of_temperature(const TomlValue& table);

/// The table [spectra]; nothing where there is none. \throws InputError.
std::optional<BandsAsked> bands_asked(const TomlValue& root);

/// The files of spectra that a scene file names.
std::vector<std::filesystem::path> spectrum_files(const TomlValue& root, const TomlFrame& frame);

/// The tables [[luminaire]], one entry for each position; photometric files are read. \throws InputError.
std::vector<LuminaireEntry> luminaires_of(const TomlValue& root, const TomlFrame& frame);

/// True when some luminaire is stated in lumens, or by a photometric file.
bool in_lumens(const TomlValue& root);

/// All lights of a scene file: luminaires, north, [site], [sun], [sky], [weather] and [ground]. \throws InputError.
LightEntries lights_of(const TomlValue& root, const TomlFrame& frame);

/// The photometric and weather files that a scene file names.
std::vector<std::filesystem::path> light_files(const TomlValue& root, const TomlFrame& frame);

}  // namespace patchlight
