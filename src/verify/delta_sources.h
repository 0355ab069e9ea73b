#pragma once

#include "patchlight/scene/daylight.h"
#include "patchlight/scene/luminaire.h"
#include "patchlight/scene/scene.h"

#include "verify/path_scene.h"

#include <array>
#include <optional>
#include <vector>

namespace patchlight {

/// The radiant intensity of a luminaire without extent in a unit direction away from it, W/sr per band. `up` decides
/// the tilt of measured luminaires. Written apart from src/lighting, so that the path tracer can test it.
Spectrum radiant_intensity(const Luminaire& luminaire, const Vector& up, const Vector& direction);

/// A point that receives light, with the unit normal of its side.
struct LitPoint {
  Point point;
  Vector normal;
};

/// A ray of light that arrives at a point if nothing is in the way.
struct LightSample {
  Point from;
  Spectrum irradiance;  ///< W/m^2, over the probability of the sample
};

/// The sources that no scattered ray finds: luminaires and the sun. Written apart from src/lighting.
class DeltaSources {
 public:
  DeltaSources(const Scene& scene, const PathScene& faces);

  bool empty() const { return luminaires_.empty() && !sun_; }
  std::size_t rays_per_point() const { return (luminaires_.empty() ? 0 : 1) + (sun_ ? 1 : 0); }

  /// One luminaire, chosen with a probability in proportion to its unoccluded irradiance, and the sun. `choice` selects
  /// the luminaire, `uv` the point on a sphere. Their mean over [0, 1)^3 is the unoccluded irradiance.
  std::vector<LightSample> sample(const LitPoint& at, double choice, const Eigen::Vector2d& uv) const;

 private:
  const PathScene& faces_;
  std::vector<Luminaire> luminaires_;
  std::optional<Sun> sun_;  // above the horizon
  Vector up_;
};

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
