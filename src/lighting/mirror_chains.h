#pragma once

#include "patchlight/scene/scene.h"

#include "lighting/light_source.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// The maximum number of mirrors on a path of light.
inline constexpr std::size_t most_mirrors = 16;

/// Paths whose mirrors leave a smaller fraction of the light are not followed.
inline constexpr double least_reflectance = 1e-3;

/// A side of a polygon that reflects light without scattering it: of a mirror, or of a clear polygon.
struct MirrorSide {
  PolygonIndex polygon = no_polygon;
  Side side = Side::front;
  Vector normal;  ///< unit, out of this side
  Point on_plane;
  double reflectance = 0;  ///< at most, over all bands; of a clear one that of light from all directions alike
};

/// A chain of mirrors from a receiver to a source. `image` reflects a point of the receiver at each of them. From the
/// source, the receiver appears at this image, straight behind the last mirror.
struct MirrorChain {
  std::vector<MirrorSide> mirrors;
  double reflectance = 1;  ///< the product of theirs
  Eigen::Affine3d image = Eigen::Affine3d::Identity();
  std::vector<std::uint32_t> sources;  ///< LightSource::id() of those whose beams get through, ascending
  double beyond = 0;  ///< bound of the light of longer chains that are not followed, as a multiple of its own light:
                      ///< images between two mirrors that face each other go on without end
};

/// Light that reaches a mirror by chains that are not followed.
struct UnfollowedLight {
  std::vector<Point> corners;  ///< of the mirror, counter-clockwise from the side that reflects
  Spectrum exitance;           ///< W/m^2, after the reflection at this mirror and at later ones
  bool is_of_faces = false;    ///< it is that of all emitter faces; else of all luminaires and the sun
};

/// Chains of planar mirrors and clear faces, those with the largest share first. The share is the fraction of a
/// source's flux that gets through the chain, for the best source. Each source sends a beam to a mirror, which the
/// outlines of the mirrors before it limit; occlusion is not considered.
struct MirrorChains {
  std::vector<MirrorChain> chains;
  std::vector<std::uint32_t> ranked;  ///< LightSource::id() of the sources that were given, ascending
  std::vector<UnfollowedLight> unfollowed;
  double unfollowed_share = 0;  ///< its flux, relative to the flux that mirrors reflect straight from the sources
  bool is_cut = false;          ///< there are more chains than are followed
};

/// Up to 1,024 chains of up to most_mirrors, the product of whose reflectances is least_reflectance or more. Best-first
/// search over beams (Heckbert and Hanrahan 1984): a chain carries no more than the shorter one that it continues. The
/// search ends after a fixed amount of work; chains that it has not reached count as unfollowed. O(sources x mirrors).
MirrorChains mirror_chains(const Scene& scene, std::span<const LightSource> sources);

}  // namespace patchlight
