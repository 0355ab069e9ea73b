#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"

#include "base/sampling.h"
#include "verify/delta_sources.h"
#include "verify/path_scene.h"
#include "visibility/flat_polygon.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

namespace patchlight {

/// A number of (0, 1) that belongs to counters.
inline double uniform(std::initializer_list<std::uint64_t> counters) { return (hash(counters) + 0.5) * 0x1p-32; }

/// The end of a ray that mirrors and clear polygons may have sent on.
struct RayEnd {
  std::optional<Hit> hit;  ///< none if the ray leaves the scene
  Vector direction;        ///< unit, at its end
  Spectrum factor;         ///< of the light from there
};

/// Follows a ray from its first hit through mirrors and clear polygons, one of its ways at each: it goes through, is
/// reflected, or ends to be scattered, in proportion to the mean shares of these.
RayEnd walk_to_end(const PathScene& scene, std::optional<Hit> hit, const Vector& direction, std::uint32_t seed);

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
