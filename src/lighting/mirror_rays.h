#pragma once

#include "lighting/lighting.h"
#include "lighting/pane_sides.h"
#include "lighting/sky_openings.h"

#include <array>
#include <span>
#include <vector>

namespace patchlight {

/// A ray that leaves a mirror towards what a place sees in it, and what a radiance of 1 in it adds to the irradiance of
/// the place, per band.
struct MirrorRay {
  Ray ray;
  Spectrum weight;
};

/// What places see in mirrors and in clear faces.
class MirrorView {
 public:
  /// Keeps references to what the second is, and to the tracing's occluder of all faces.
  MirrorView(const Scene& scene, const PaneSides& sides, const Tracing& tracing);

  /// Half of the samples stand for directions distributed as the cosine over the hemisphere, the others for places on
  /// the mirrors before the receiver, both put together by the balance heuristic (Veach and Guibas 1995). Along each
  /// direction every mirror and clear face that is met, up to something that lets nothing through, has a ray.
  void add_rays(const SurfacePoint& at, std::span<const std::array<double, 4>> samples,
                std::vector<MirrorRay>& into) const;

  /// The rays that leave mirrors which these meet on their way, straight on or through clear faces; of each as much as
  /// its weight is, relative to `whole`, 1e-3 or more.
  std::vector<MirrorRay> further(std::span<const MirrorRay> rays, double whole) const;

 private:
  struct Aim {
    std::vector<double> probabilities;  // of each target to be chosen
    double density(const MirrorView& view, const SurfacePoint& at, const Vector& direction) const;
  };
  Aim aim_from(const SurfacePoint& at) const;
  void follow(Ray ray, Spectrum weight, std::vector<MirrorRay>& into) const;

  const PaneSides& sides_;
  const Occluder& occluder_;
  std::vector<Opening> targets_;  // the largest mirrors and clear faces
};

}  // namespace patchlight
