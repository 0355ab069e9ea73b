#pragma once

#include "input/radiance/radiance_text.h"

#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The surfaces that Radiance's genbox prints for the words behind its name: "MATERIAL NAME X Y Z" and the options
/// -b BEVEL, -r RADIUS and -i (fronts inward). The box reaches from the origin to (X, Y, Z). \throws InputError at
/// `where`: an option is not known, a word is missing, or a length does not fit.
std::vector<RadiancePrimitive> radiance_genbox(std::span<const std::string> arguments, const std::string& where);

}  // namespace patchlight
