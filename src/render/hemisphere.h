#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// What rays over a hemisphere say.
struct HemisphereIrradiance {
  Spectrum irradiance;  ///< W/m^2
  Spectrum variance;    ///< of it
  Field gradient;       ///< per metre the point is moved along x, y and z (rows), W/m^3 per band
};

/// Directions over a hemisphere, distributed as the cosine: one in each of M rings by N sectors of equal weight.
class Hemisphere {
 public:
  /// About `rays` directions around a unit normal.
  Hemisphere(int rays, const Vector& normal);

  /// Ring by ring; random in their cells.
  std::vector<Vector> directions(std::uint32_t seed) const;

  /// The irradiance by the radiosity that each of these finds, W/m^2, and how far away, metres: its mean, as directions
  /// are distributed as cos / pi. Its gradient by what moves in and out of each cell when the point moves: Ward and
  /// Heckbert 1992, Irradiance Gradients, the translational one. Its variance by what neighbours in a ring differ.
  HemisphereIrradiance irradiance(const FieldView& radiosity, std::span<const double> distances) const;

  /// Of so many distances, metres; infinite when all are.
  double harmonic_mean(std::span<const double> distances) const;

 private:
  std::size_t cell(int ring, int sector) const;
  double sine(int ring) const;  // of the polar angle where a ring begins

  int rings_, sectors_;
  Vector normal_, first_, second_;
};

}  // namespace patchlight
