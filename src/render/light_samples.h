#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"

#include "lighting/light_source.h"
#include "lighting/sky_irradiance.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A triangle as it is seen from a point.
class SphericalTriangle {
 public:
  SphericalTriangle(const Point& from, const std::array<Point, 3>& corners);

  /// sr; 0 where it is seen from its edge.
  double solid_angle() const { return solid_angle_; }

  /// Uniformly distributed in its solid angle, for (u, v) of the unit square: Arvo 1995, Stratified Sampling of
  /// Spherical Triangles. The solid angle must be above 0.
  Vector direction(double u, double v) const;

  /// True when a direction goes through it.
  bool contains(const Vector& direction) const;

  /// The mean over its corners of the cosines to a normal, 0 for those below the horizon: about that of its directions.
  double mean_cosine(const Vector& normal) const;

 private:
  Vector a_, b_, c_;     // unit, counter-clockwise
  Vector ab_, bc_, ca_;  // across its edges, inwards
  double solid_angle_ = 0;
};

/// A point that gets light, and the origin of its random numbers.
struct LitPoint {
  SurfacePoint at;
  std::uint32_t sample = 0;     ///< place in a sequence: those of one sequence are spread evenly together
  std::uint32_t seed = 0;       ///< of the sequence
  const SkyAim* aim = nullptr;  ///< rays to the sky; null where there is none
};

/// One estimate of the irradiance of each point (row) by lights that shine on it straight or through clear faces,
/// W/m^2 per band; its mean over all samples is the irradiance. About `rays` rays, 2 or more, go to the sources that
/// LightSampler::choose() selects, and `rays` to the sky.
Field light_samples(const LightSampler& lights, std::span<const LitPoint> points, std::uint32_t rays);

/// An aim at its most probable openings, as each point looks at all triangles of these; others are left to rays over
/// the hemisphere.
SkyAim aim_at_few(const SkyAim& aim, const std::vector<Opening>& openings);

}  // namespace patchlight
