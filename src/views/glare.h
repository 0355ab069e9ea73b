#pragma once

#include "patchlight/base/geometry.h"

#include "scene/photometric_web.h"

#include <optional>
#include <span>

namespace patchlight {

/// The position index p of Guth, of a glare source in a direction from an observer who looks along `forward`, both
/// unit; `upward` is unit and at right angles to that. 1 on the line of sight. Above it the formula of CIE 117:1995
/// (Levin 1975 for Guth's data); below it Iwata and Tokura 1997.
double position_index(const Vector& direction, const Vector& forward, const Vector& upward);

/// A source of glare, or a part of one.
struct GlareSource {
  double luminance = 0;       ///< cd/m^2
  double solid_angle = 0;     ///< sr
  double position_index = 1;  ///< p
};

/// The unified glare rating 8 log10(0.25 / L_b sum L^2 omega / p^2), CIE 117:1995, of a background luminance in cd/m^2;
/// nothing without sources or background.
std::optional<double> unified_glare_rating(std::span<const GlareSource> sources, double background);

}  // namespace patchlight
