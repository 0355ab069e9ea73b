#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/luminaire.h"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace patchlight {

/// How a photometric file counts its angles, in the frame of a luminaire with the unit vectors aim, zero plane z and
/// side s = z x aim. For type C the vertical angle v is counted from the aim, the horizontal one h around it from z:
/// direction cos v aim + sin v (cos h z + sin h s). For A and B both are 0 along the aim, and the luminaire's top
/// is z: v goes up, h to the side -s. A turns about the vertical axis first, cos v (cos h aim - sin h s) + sin v z; B
/// about the horizontal one, cos h (cos v aim + sin v z) - sin h s.
enum class PhotometricType : std::uint8_t { a, b, c };

/// The shape of a luminous opening by the signs of its width, length and height, IES LM-63-02 table 1.
enum class OpeningShape : std::uint8_t {
  box,                 ///< a rectangle, with a height a box: none negative
  upright_cylinder,    ///< an ellipse, with a height a cylinder: - - +
  cylinder_by_length,  ///< a tube along the length: - + -
  cylinder_by_width,   ///< a tube along the width: + - -
  ellipsoid            ///< - - -
};

/// The intensities of a luminaire as measured by its maker: the content of an IES LM-63 file.
struct PhotometricWeb {
  std::string file{};  ///< for messages
  PhotometricType type = PhotometricType::c;
  std::vector<double> vertical{};    ///< degrees, ascending
  std::vector<double> horizontal{};  ///< degrees, ascending; without angles that follow from symmetry
  std::vector<double> candela{};     ///< at horizontal h and vertical v: [h * vertical.size() + v], all factors applied
  Vector opening = Vector::Zero();   ///< luminous width, length and height in meters; 0 for a point
  OpeningShape shape = OpeningShape::box;
  double lamp_lumens = 0;             ///< of all lamps together, lm; 0 with absolute photometry, which does not say
  double watts = 0;                   ///< electrical input
  std::vector<double> tilt{};         ///< degrees between the aim and straight down, ascending; empty: does not matter
  std::vector<double> tilt_factor{};  ///< factors of the candela at these tilts
};

/// The frame of a luminaire: two unit vectors at right angles.
struct LuminaireFrame {
  Vector aim;
  Vector zero_plane;
};

/// Candela in a direction, bilinear in the angles; 0 at vertical angles beyond the table. The last horizontal angle
/// defines the symmetry, IES LM-63-02 section 5.13. Type C: 0 degrees is rotational, 90 has equal quadrants, 180 (or 90
/// to 270) has equal halves. Types A and B from 0: left and right are equal. O(log n) for n angles.
double candela(const PhotometricWeb& web, const LuminaireFrame& frame, const Vector& direction);

/// The factor of a tilted luminaire's candela; linear between the table's angles. 1 without a table.
double tilt_factor(const PhotometricWeb& web, double tilt_degrees);

/// Flux of the luminaire in lumens, not tilted: the integral of candela() over the sphere, by the midpoint rule on half
/// a degree.
double luminous_flux(const PhotometricWeb& web);

/// The area in m^2 of a luminaire's luminous opening (PhotometricWeb::opening) across a unit direction, as CIE 117:1995
/// takes it for A_p; 0 of a point. Length lies along the zero plane, width across it, height along the aim (IES
/// LM-63-02).
double projected_opening(const PhotometricWeb& web, const LuminaireFrame& frame, const Vector& direction);

/// The spectrum of a luminaire, const or not, to which its light is proportional.
template <typename AnyLuminaire>
auto& strength_of(AnyLuminaire& luminaire) {
  const auto strength = [](auto& light) -> auto& {
    if constexpr (requires { light.intensity; })
      return light.intensity;
    else if constexpr (requires { light.exitance; })
      return light.exitance;
    else
      return light.watts_per_lumen;
  };
  return std::visit(strength, luminaire.light);
}

/// A luminaire that gives a share of its light.
inline Luminaire dimmed(Luminaire luminaire, double share) {
  strength_of(luminaire) *= share;
  return luminaire;
}

}  // namespace patchlight
