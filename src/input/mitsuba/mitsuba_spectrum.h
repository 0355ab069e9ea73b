#pragma once

#include "input/mitsuba/mitsuba_file.h"

#include <optional>
#include <span>
#include <string>
#include <utility>

namespace patchlight {

/// A colour as linear RGB, and what of it could not be carried.
struct MitsubaColour {
  Spectrum value;
  std::string simplified;  ///< for a note; empty if nothing is lost
};

/// What <rgb>, <srgb>, <spectrum>, <blackbody>, <float> or a texture says; pictures and checkerboards count by their
/// mean, other textures as 0.5. Nothing for another element. \throws InputError naming the line.
std::optional<MitsubaColour> mitsuba_colour(const MitsubaFile& file, const pugi::xml_node& node);

/// The linear RGB (Rec. 709) of a spectrum that is piecewise linear between (wavelength in nm, value), 0 beyond, by the
/// colour matching functions of the CIE 1931 observer as Wyman, Sloan and Shirley 2013 fit them. An even spectrum of 1
/// is 1, 1, 1.
Spectrum rgb_of_wavelengths(std::span<const std::pair<double, double>> samples);

}  // namespace patchlight
