#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <memory>
#include <string>
#include <variant>

namespace patchlight {

struct PhotometricWeb;  // scene/photometric_web.h

/// The same intensity in all directions.
struct PointLight {
  Spectrum intensity;  ///< W/sr
};

/// A beam around the luminaire's aim: half the intensity of the axis at the beam's half angle, a tenth at the field's.
struct SpotLight {
  Spectrum intensity;            ///< on the axis, W/sr
  double beam_half_angle = 15;   ///< degrees from the axis, above 0
  double field_half_angle = 25;  ///< degrees, above the beam's and at most 90
};

/// A measured distribution.
struct WebLight {
  std::shared_ptr<const PhotometricWeb> web;  ///< never null
  Spectrum watts_per_lumen;                   ///< per band; 1/179 for white light
};

/// A sphere that emits evenly. Its center is the luminaire's position. It casts no shadows.
struct SphericalLamp {
  double radius = 0;  ///< m, above 0
  Spectrum exitance;  ///< W/m^2
};

/// A lamp that is no polygon. Spectra have the scene's number of bands; lumens are W by 179 lm/W.
struct Luminaire {
  std::string name;
  std::string place;                    ///< where it is stated, for messages: "office.toml:31"
  Point position = Point::Zero();       ///< of the photometric center, m
  Vector aim = -Vector::UnitZ();        ///< unit; the nadir of its photometry, the axis of a spot
  Vector zero_plane = Vector::UnitX();  ///< unit, at right angles to the aim; towards the horizontal angle 0
  std::variant<PointLight, SpotLight, WebLight, SphericalLamp> light;
  std::shared_ptr<const SampledSpectrum> spectrum{};  ///< how its light is spread, until the scene has its bands; any
                                                      ///< multiple of it; null: as its color
};

/// The intensity of a spot, as a share of that on its axis, at an angle with this cosine:
/// 2^-(angle / beam_half_angle)^p with p such that it is 0.1 at the field's half angle.
double spot_profile(const SpotLight& spot, double cosine);

/// The flux of a spot for an intensity of 1 on its axis, in sr: the integral of its profile, to 1e-6 of it.
double spot_solid_angle(const SpotLight& spot);

}  // namespace patchlight
