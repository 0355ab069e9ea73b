#pragma once

#include "patchlight/scene/daylight.h"
#include "patchlight/scene/luminaire.h"
#include "patchlight/scene/scene.h"

#include "verify/path_scene.h"
#include "visibility/flat_polygon.h"

#include <array>
#include <cstdint>
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

/// Random numbers of one sample, each of [0, 1) and independent.
struct MirrorSample {
  double first_mirror = 0;
  double luminaire = 0;
  Eigen::Vector2d on_luminaire = Eigen::Vector2d::Zero();
  std::uint64_t seed = 0;  ///< of the mirrors that follow
};

/// Light of luminaires and sun by way of mirrors and clear polygons, without a list of images. A sample draws a chain
/// of mirrors: the first next to the source, the others with a probability each time (Russian roulette). Every chain of
/// any length has a positive probability, so the estimate is unbiased. Mirrors are drawn in proportion to the light
/// that test rays from the sources bring to them, mixed with a uniform distribution.
class MirrorImages {
 public:
  MirrorImages(const Scene& scene, const PathScene& faces, const DeltaSources& sources, std::uint64_t seed);

  bool empty() const { return sides_.empty(); }

  /// One sample of the irradiance of a point on a polygon, W/m^2 per band.
  Spectrum sample_irradiance(const LitPoint& at, PolygonIndex polygon, const MirrorSample& sample) const;

 private:
  // A side that reflects as a mirror does.
  struct MirrorSide {
    PolygonIndex polygon = no_polygon;
    Side side = Side::front;
    FlatPolygon outline;
    Vector normal;           // unit, out of this side
    double reflectance = 0;  // probability that a chain goes on after it
    double height(const Point& point) const { return normal.dot(point - outline.origin); }
    Point mirrored(const Point& point) const { return point - 2 * height(point) * normal; }
  };

  // Weights of the sides as the next one of a chain; their sums decide the draws.
  struct Tally {
    std::vector<std::uint32_t> side;
    std::vector<double> weight;
    double sum = 0;
    void add(std::uint32_t to, double light);
  };
  struct Draw {
    std::uint32_t side = 0;
    double probability = 0;
  };

  Draw draw_side(const Tally& tally, double u) const;
  Spectrum along_chain(const std::vector<std::uint32_t>& chain, const LitPoint& at, PolygonIndex polygon,
                       const MirrorSample& sample) const;
  std::optional<std::vector<Segment>> unfold(const std::vector<std::uint32_t>& chain, const std::vector<Point>& images,
                                             const Point& source, PolygonIndex polygon) const;
  void tally_light(const Scene& scene, std::uint64_t seed);
  void follow(std::uint32_t side, Ray ray, double light);

  const PathScene& faces_;
  const DeltaSources& sources_;
  std::vector<MirrorSide> sides_;
  std::vector<std::uint32_t> side_of_;  // at 2 * polygon + side
  Tally first_;
  std::vector<Tally> next_;  // per side
};

}  // namespace patchlight
