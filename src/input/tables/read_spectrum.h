#pragma once

#include "patchlight/light/spectrum.h"

#include <filesystem>
#include <string_view>

namespace patchlight {

/// Reads a spectrum: lines of a wavelength in nm and a value, separated by a comma, a semicolon or spaces, with
/// comments from # on and one line of headings; or what Argyll's spotread writes (CGATS, SPECTRAL_BANDS and so on), of
/// which the first set of values counts, divided by SPECTRAL_NORM. \throws InputError naming file and line: wavelengths
/// that do not grow, values below 0 or not finite, or no spectrum at all.
SampledSpectrum read_spectrum(const std::filesystem::path& file);

/// The same of a text.
SampledSpectrum parse_spectrum(std::string_view text, const std::filesystem::path& file);

}  // namespace patchlight
