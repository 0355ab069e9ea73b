#pragma once

#include "patchlight/input/read_scene.h"

#include "input/toml/toml_models.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace patchlight {

/// True for a value that stands for a spectrum by wavelength: a text, or a table.
bool is_by_wavelength(const TomlValue& value);

/// A reflectance or transmittance by wavelength: a file that read_spectrum() reads. \throws InputError.
std::shared_ptr<const SampledSpectrum> sampled_share(const TomlValue& value, const TomlFrame& frame);

/// What a lamp emits by wavelength, per nm: such a file.  \throws InputError.
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

}  // namespace patchlight
