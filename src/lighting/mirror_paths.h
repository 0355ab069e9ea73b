#pragma once

#include "patchlight/base/field.h"

#include "lighting/light_paths.h"
#include "lighting/mirror_chains.h"
#include "lighting/sky_openings.h"
#include "visibility/flat_polygon.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// The fraction of light from one point to another via mirrors: the product of the mirror reflectances and of the
/// transmittances of LightPaths between them.
class MirrorPaths {
 public:
  MirrorPaths(const Scene& scene, MirrorChains chains);

  const MirrorChains& found() const { return chains_; }
  const std::vector<MirrorChain>& chains() const { return chains_.chains; }

  /// False where no light of a source, by its MirroredSource::id, gets through a chain.
  bool carries(const MirrorChain& chain, std::uint32_t source) const;

  /// Irradiance at a place if the light that is not followed left each mirror diffusely and nothing were in the way.
  Spectrum unfollowed_irradiance(const Point& place, const Vector& normal) const;

  /// Per segment (row), from a receiver to a source, and band (column), by way of the mirrors of a chain: 0 where the
  /// straight line from the receiver's image to the source misses one of them.
  Field transmittance(const MirrorChain& chain, const LightPaths& paths, std::span<const Segment> segments) const;

  /// False if no straight line from the image of a receiver's ball to a source's ball, or in a source's direction,
  /// meets the last mirror of a chain. Cheap and conservative: it may return true without need.
  bool may_pass(const MirrorChain& chain, const Ball& receiver, const Ball& source) const;
  bool may_pass(const MirrorChain& chain, const Ball& receiver, const Vector& toward_source) const;

  const PaneSides& sides() const { return sides_; }

 private:
  struct Way;
  std::vector<Way> ways(const MirrorChain& chain, std::span<const Segment> segments) const;

  MirrorChains chains_;
  PaneSides sides_;
  double least_height_;            // meters
  std::vector<FlatPolygon> flat_;  // per polygon; empty where it is no mirror
  std::vector<Ball> balls_;        // around each of these
};

/// A ray from a mirror along which a place sees light, and the irradiance of the place by a radiance of 1 in the ray,
/// per band.
struct MirrorRay {
  Ray ray;
  Spectrum weight;
};

/// Samples the light that places see in mirrors and in clear faces.
class MirrorView {
 public:
  /// Keeps references to `sides` and to the tracing's occluder of all faces.
  MirrorView(const Scene& scene, const PaneSides& sides, const Tracing& tracing);

  /// Half of the samples represent directions distributed as the cosine over the hemisphere, the others points on the
  /// mirrors before the receiver. The balance heuristic combines both (Veach and Guibas 1995). Each direction has a ray
  /// for every mirror and clear face on it, up to the first opaque face.
  void add_rays(const SurfacePoint& at, std::span<const std::array<double, 4>> samples,
                std::vector<MirrorRay>& into) const;

  /// The rays that leave mirrors which these meet on their way, straight on or through clear faces; without
  /// those whose weight relative to `whole` is below least_reflectance.
  std::vector<MirrorRay> further(std::span<const MirrorRay> rays, double whole) const;

 private:
  std::vector<double> probabilities_from(const SurfacePoint& at) const;
  double aimed_density(std::span<const double> probabilities, const SurfacePoint& at, const Vector& direction) const;
  void follow(Ray ray, Spectrum weight, std::vector<MirrorRay>& into) const;

  const PaneSides& sides_;
  const Occluder& occluder_;
  std::vector<Opening> targets_;  // the largest mirrors and clear faces
};

}  // namespace patchlight
