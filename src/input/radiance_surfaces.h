#pragma once

#include "input/radiance_text.h"
#include "input/round_shapes.h"

#include <optional>
#include <string>

namespace patchlight {

/// True for the kinds of surfaces that have a shape of their own: polygon, sphere, bubble, cylinder, tube, cone, cup
/// and ring.
bool is_radiance_surface(const std::string& kind);

/// True for those that facets stand for.
bool is_round(const std::string& kind);

/// The faces of such a surface, in units of the file; a polygon has one. \throws InputError at `where`: it has another
/// number of arguments than it should, a length or a radius that is not above 0.
FacetedShape radiance_surface(const RadiancePrimitive& primitive, const std::string& where);

}  // namespace patchlight
