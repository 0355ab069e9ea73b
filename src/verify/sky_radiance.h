#pragma once

#include "patchlight/scene/daylight.h"

#include <array>

namespace patchlight {

/// The radiance of sky and ground by direction. Written apart from src/lighting, so that the path tracer can test it.
class SkyRadiance {
 public:
  SkyRadiance(const Sky& sky, const Vector& up);

  /// W/(m^2 sr) from a unit direction.
  Spectrum radiance_from(const Vector& direction) const;

 private:
  double relative(const Vector& direction) const;
  double relative_horizontal_irradiance() const;

  SkyKind kind_;
  Vector up_;
  Vector sun_;
  std::array<double, 5> coefficients_{};  // a to e of the gradation and the indicatrix
  Spectrum scale_;                        // W/(m^2 sr) for a relative radiance of 1
  Spectrum ground_;                       // W/(m^2 sr)
};

}  // namespace patchlight
