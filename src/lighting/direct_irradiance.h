#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "lighting/lighting.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Shadow rays of a patch of mean size; others take a quarter to four times as many, by the square root of their area,
/// over mirrors no more than as many. Powers of two that are at least 4 stratify best. Points take sixteen times as
/// many to a ball and over mirrors, and four times as many to the sky.
struct LightingOptions {
  int lamp_samples = 64;  ///< per luminaire; where they would be more than 16, none to a ball that nothing can hide;
                          ///< at a point those without extent take one
  int sun_samples = 64;   ///< 64 times that where shadows are too many to be found by geometry; at a point one
  int mirrored_samples = 64;  ///< per source and way over mirrors, see mirrored_irradiance(); 2 or more
  int sky_samples = 512;      ///< directions; half of them towards panes, or half as many again towards holes
  std::uint64_t seed = 1;
  std::vector<double> areas = {};  ///< per patch: in proportion to which it matters, m^2; empty: its own area
  double usual_area = 0;           ///< area of the patch that takes just these numbers of rays, m^2; 0: the mean of all
  std::span<const std::uint8_t> doublings = {};  ///< per patch: how often that number is doubled; empty: never
  std::uint32_t alike = 1;  ///< 1 or more: so many patches that follow each other take the same samples, so that little
                            ///< noise is in their differences
};

/// Irradiance by light that comes from no patch, W/m^2: one row per patch or point, one column per band.
struct DirectIrradiance {
  Field irradiance;
  Field standard_error;  ///< from four independent scrambles of the samples, at points sixteen, over mirrors two to
                         ///< eight; as large as the irradiance where there is one sample alone; 0 where nothing is
                         ///< sampled. Where n rays to a light without extent, or from a point
                         ///< to a ball, all find the same: 3 / n of its light without shadows. It leaves out holes
                         ///< that all rays of a patch to a ball or to the sky miss, smaller than one ray's share
};

/// More light on the same patches or points, whose errors have nothing to do with each other.
void add(DirectIrradiance& direct, const DirectIrradiance& more);

/// Mean irradiance of every patch, over the part of it over which no other polygon lies: Owen-scrambled Sobol points
/// over patch and source, one shadow ray each; for luminaires without extent by the solid angle under which these see
/// the patch. The share of a patch that these or the sun reach is exact up to rounding, from the outlines of all
/// shadows, unless about 1,500 triangles stand between: however small a hole is, it is found. O(patches x (luminaires x
/// lamp_samples + sun_samples + sky_samples)). \throws Cancelled.
DirectIrradiance direct_irradiance(const Lighting& lighting, const PatchMesh& mesh, const LightingOptions& options = {},
                                   const Observer& observer = {});

/// Standard errors of patches, each no less than the root mean square of those around it by their areas, m^2: the
/// spread of four estimates may be small by chance, and all four may miss the edge of a shadow that patches around
/// find. Errors are compared by as many rays, with LightingOptions::doublings.
Field with_errors_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const Field& standard_error,
                         std::span<const std::uint8_t> doublings = {});

/// Irradiance at points.
DirectIrradiance direct_irradiance(const Lighting& lighting, std::span<const SurfacePoint> points,
                                   const LightingOptions& options = {}, const Observer& observer = {});

}  // namespace patchlight
