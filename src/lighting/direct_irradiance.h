#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "lighting/light_source.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Shadow rays of a patch of mean size. Other patches take a quarter to four times as many, by the square root of their
/// area; over mirrors no more than this number. Powers of two of at least 4 stratify best. Points take sixteen times as
/// many to a ball and over mirrors, and four times as many to the sky.
struct LightingOptions {
  int luminaire_samples = 64;  ///< per luminaire; where they would be more than 16, none to a ball that nothing can
                               ///< hide; at a point those without extent take one
  int sun_samples = 64;        ///< 64 times that where shadows are too many to be found by geometry; at a point one
  int mirrored_samples = 64;   ///< per source and way over mirrors; 2 or more
  int sky_samples = 512;       ///< directions; half of them towards panes, or half as many again towards holes
  std::uint64_t seed = 1;
  std::vector<double> areas = {};  ///< per patch: its importance, m^2; empty: its own area
  double usual_area = 0;           ///< area of the patch that takes just these numbers of rays, m^2; 0: the mean of all
  std::span<const std::uint8_t> doublings = {};  ///< per patch: how often that number is doubled; empty: never
  std::uint32_t alike = 1;       ///< 1 or more: this many consecutive patches take the same samples, which reduces the
                                 ///< noise in their differences
  bool only_in_mirrors = false;  ///< leaves out light that arrives without a reflection
};

/// Irradiance by light that does not come from patches, W/m^2: one row per patch or point, one column per band.
struct DirectIrradiance {
  Field irradiance;
  Field standard_error;   ///< from four independent scrambles of the samples, at points sixteen, over mirrors two to
                          ///< eight; as large as the irradiance where there is one sample alone; 0 where nothing is
                          ///< sampled. Where n rays to a light without extent, or from a point
                          ///< to a ball, all find the same: 3 / n of its light without shadows. It leaves out holes
                          ///< that all rays of a patch to a ball or to the sky miss, smaller than one ray's share
  Field unfollowed = {};  ///< the part of the standard error that more samples do not reduce: the bound of the light
                          ///< over mirrors that is not followed, 0 without mirrors
};

/// Adds more light on the same patches or points, with independent errors.
void add(DirectIrradiance& direct, const DirectIrradiance& more);

/// Mean irradiance of every patch, over its part that no other polygon covers: straight light of luminaires, sun and
/// sky, and light of these and of emitter faces that arrives by mirrors and clear faces, where reflections are
/// followed. The straight light of emitter faces is left to their form factors. Uses Owen-scrambled Sobol points over
/// patch and source, with one shadow ray each. Luminaires without extent are sampled by the solid angle of the patch
/// from the luminaire. The fraction of a patch lit by these or by the sun is exact up to rounding, from the outlines of
/// all shadows, so no hole is missed. With more than about 1,500 triangles in between, it is sampled too. Mirrors are
/// followed by virtual sources, and by random paths for the sky: docs/theory/panes-mirrors-sheets.md. O(patches x
/// (sources x (luminaire_samples + chains x mirrored_samples) + sun_samples + sky_samples)). \throws Canceled.
DirectIrradiance direct_irradiance(const LightSampler& lights, const PatchMesh& mesh,
                                   const LightingOptions& options = {}, const Observer& observer = {});

/// Irradiance at points.
DirectIrradiance direct_irradiance(const LightSampler& lights, std::span<const SurfacePoint> points,
                                   const LightingOptions& options = {}, const Observer& observer = {});

/// Standard errors of patches, each at least the root mean square of those around it, weighted by area, m^2. The spread
/// of four estimates may be small by chance, and all four may miss the edge of a shadow that neighbors find.
/// LightingOptions::doublings scale errors to equal numbers of rays.
Field with_errors_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const Field& standard_error,
                         std::span<const std::uint8_t> doublings = {});

}  // namespace patchlight
