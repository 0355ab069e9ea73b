#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace patchlight {

/// How a photometric file counts its angles. C: vertical angle from the nadir, horizontal angle around that axis from
/// the 0 degree plane. B and A: the polar axis lies across; vertical angles are latitudes over its equator, horizontal
/// angles run around it (B) or along it (A). IES LM-63-02, annex on photometric types.
enum class PhotometricType : std::uint8_t { a, b, c };

/// The intensities of a luminaire as measured by its maker: what an IES LM-63 file holds.
struct PhotometricWeb {
  std::string file;  ///< for messages
  PhotometricType type = PhotometricType::c;
  std::vector<double> vertical;     ///< degrees, ascending
  std::vector<double> horizontal;   ///< degrees, ascending; what symmetry tells is left out, as in the file
  std::vector<double> candela;      ///< at horizontal h and vertical v: [h * vertical.size() + v], all factors applied
  Vector opening = Vector::Zero();  ///< luminous width, length and height in metres; 0 for a point
  double lamp_lumens = 0;           ///< of all lamps together, lm; 0 with absolute photometry, which does not say
  double watts = 0;                 ///< electrical input
};

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
  Spectrum watts_per_lumen;                   ///< per band; 1 / luminous_efficacy (light/photometry.h) for white light
};

/// A sphere that emits evenly. Its centre is the luminaire's position. It casts no shadows.
struct SphericalLamp {
  double radius = 0;  ///< m, above 0
  Spectrum exitance;  ///< W/m^2
};

/// A lamp that is no polygon. Spectra have the scene's number of bands; lumens are W by 179 lm/W
/// (light/photometry.h).
struct Luminaire {
  std::string name;
  std::string place;                    ///< where it is stated, for messages: "office.toml:31"
  Point position = Point::Zero();       ///< of the photometric centre, m
  Vector aim = -Vector::UnitZ();        ///< unit; the nadir of its photometry, the axis of a spot
  Vector zero_plane = Vector::UnitX();  ///< unit, at right angles to the aim; towards the horizontal angle 0
  std::variant<PointLight, SpotLight, WebLight, SphericalLamp> light;
};

}  // namespace patchlight
