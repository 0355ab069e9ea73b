#pragma once

#include "patchlight/base/geometry.h"

#include <span>

namespace patchlight {

/// Unoccluded exchange area A_1 F_12 in m^2 of two planar convex polygons that may touch, cross each other's plane, or
/// share an edge; each faces the side from which its corners run counter-clockwise. What lies behind the other's plane
/// is clipped away first. Relative error below 1e-6 for touching polygons of aspect up to 10, far less for separate
/// ones, below 1e-4 for those that cross each other's plane. Symmetric in its arguments up to these errors. Schröder
/// and Hanrahan 1993 give the closed form; here Stokes' double contour integral (Sparrow 1963) with the inner integral
/// exact and the outer one by graded Gauss-Legendre quadrature; docs/theory/unoccluded-form-factors.md.
double contour_exchange_area(std::span<const Point> first, std::span<const Point> second);

}  // namespace patchlight
