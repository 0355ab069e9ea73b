#pragma once

#include "patchlight/light/spectrum.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace patchlight {

/// A convex polygon of a plane, counter-clockwise.
using PlanarOutline = std::vector<Eigen::Vector2d>;

/// The area of an outline, m^2; negative when it runs clockwise.
double area_of(const PlanarOutline& outline);

/// The part of an outline to the left of a line, which goes through `on_line` along `along`; empty when nothing is.
PlanarOutline left_of(const PlanarOutline& outline, const Eigen::Vector2d& on_line, const Eigen::Vector2d& along);

/// The shadow of something on a region.
struct Shade {
  PlanarOutline outline;
  const Spectrum* transmittance = nullptr;  ///< of what throws it; lives elsewhere; null: opaque
};

/// Integral over a convex region of the product of what all shades there let through, m^2 per band: exact up to
/// rounding. Shades may overlap and reach beyond the region. Regions in which many meet are halved first. Nothing when
/// that would take too long.
std::optional<Spectrum> lit_area(const PlanarOutline& region, const std::vector<Shade>& shades, Eigen::Index bands);

}  // namespace patchlight
