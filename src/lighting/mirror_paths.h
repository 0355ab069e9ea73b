#pragma once

#include "patchlight/base/field.h"

#include "base/sampling.h"
#include "lighting/light_paths.h"
#include "lighting/mirror_chains.h"
#include "lighting/sky_openings.h"
#include "visibility/flat_polygon.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace patchlight {

/// The fraction of light from one point to another via mirrors: the product of the mirror reflectances and of the
/// transmittances of LightPaths between them.
class MirrorPaths {
 public:
  MirrorPaths(const Scene& scene, std::shared_ptr<const SurfaceOptics> optics, MirrorChains chains);

  const MirrorChains& found() const { return chains_; }
  const std::vector<MirrorChain>& chains() const { return chains_.chains; }

  /// False where no light of a source, by its LightSource::id(), gets through a chain.
  bool carries(const MirrorChain& chain, std::uint32_t source) const;

  /// Irradiance at a place if the light that is not followed left each mirror diffusely and nothing were in the way:
  /// that of all emitter faces if `lights` has any, and that of all luminaires and the sun if it has any of these.
  Spectrum unfollowed_irradiance(const LightSampler& lights, const Point& place, const Vector& normal) const;

  /// Per segment (row), from a receiver to a source, and band (column), by way of the mirrors of a chain: 0 where the
  /// straight line from the receiver's image to the source misses one of them.
  Field transmittance(const MirrorChain& chain, const LightPaths& paths, std::span<const Segment> segments) const;

  /// False if no straight line from the image of a receiver's ball to a source's ball, or in a source's direction,
  /// meets the last mirror of a chain. Cheap and conservative: it may return true without need.
  bool may_pass(const MirrorChain& chain, const Ball& receiver, const Ball& source) const;
  bool may_pass(const MirrorChain& chain, const Ball& receiver, const Vector& toward_source) const;

 private:
  struct Way;
  std::vector<Way> ways(const MirrorChain& chain, std::span<const Segment> segments) const;

  MirrorChains chains_;
  std::shared_ptr<const SurfaceOptics> optics_;
  double least_height_;            // meters
  std::vector<FlatPolygon> flat_;  // per polygon; empty where it is no mirror
  std::vector<Ball> balls_;        // around each of these
};

/// A ray from a place.
struct WeightedRay {
  Ray ray;
  double weight = 0;  ///< the share of the place's irradiance by a radiance of 1 along this ray, sr
};

/// Samples the directions in which places may see clear faces and mirrors.
class SpecularAim {
 public:
  SpecularAim(const Scene& scene, const SurfaceOptics& optics);

  /// False if there are too many clear faces and mirrors for all to be targets.
  bool has_all_faces() const { return has_all_faces_; }

  /// The targets of a place, by their apparent sizes: the 32 largest and those of equal size. Empty if no target is
  /// above the place's horizon.
  Chooser targets_from(const SurfacePoint& at) const;

  /// Half of the samples, two numbers each, become directions distributed as the cosine over the hemisphere. The others
  /// become points on targets, chosen by `targets`. The balance heuristic combines both (Veach and Guibas 1995).
  /// Without targets all are distributed as the cosine.
  std::vector<WeightedRay> rays(const SurfacePoint& at, const Chooser& targets,
                                std::span<const std::array<double, 2>> samples) const;

 private:
  double aimed_density(const Chooser& targets, const SurfacePoint& at, const Vector& direction) const;

  bool has_all_faces_ = true;
  std::vector<Opening> targets_;  // the clear faces and mirrors, the largest first
};

/// The mirrors and clear faces of a scene, as virtual sources and as targets of rays.
struct Mirrors {
  MirrorPaths paths;
  SpecularAim aim;
  const Occluder& occluder;  ///< of all faces

  /// Chains of the lighting's luminaires and sun, and of the strongest emitting polygons.
  Mirrors(const Scene& scene, const Tracing& tracing, const Lighting& lighting);
};

}  // namespace patchlight
