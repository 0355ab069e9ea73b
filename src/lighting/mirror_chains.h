#pragma once

#include "patchlight/scene/scene.h"

#include "lighting/lighting.h"
#include "visibility/occluder.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// All points up to a distance from a center, meters.
struct Ball {
  Point centre = Point::Zero();
  double radius = 0;
};

/// The smallest ball around the middle of points.
Ball ball_around(std::span<const Point> points);

/// The light of one sample of a source at a place if nothing is in the way.
struct MirroredArrival {
  Segment segment;  ///< from the place to the source
  Spectrum irradiance;
};

/// Light that arrives at the image of a place from one direction, for each sample of a source.
using ArrivalAtImage = std::function<std::optional<MirroredArrival>(const SurfacePoint& at, const SurfacePoint& image,
                                                                    const Eigen::Vector2d& uv)>;

/// Where a source is: in a ball, or in a direction.
struct SourceExtent {
  std::optional<Vector> direction;
  Ball ball;
};

/// A source and how its light arrives by way of mirrors.
struct MirroredSource {
  std::uint32_t id = 0;  ///< the same for a source in every list of one lighting; faces of one polygon share theirs
  ArrivalAtImage arrival;
  SourceExtent extent;
  Vector axis = -Vector::UnitZ();  ///< unit; narrow beams lie around it
};

/// Luminaires and sun of a lighting, and lamps. Both must outlive the sources.
std::vector<MirroredSource> mirrored_sources(const Lighting& lighting, std::span<const LampFace> lamps);

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
  std::vector<std::uint32_t> sources;  ///< MirroredSource::id of those whose beams get through, ascending
  double beyond = 0;  ///< bound of the light of longer chains that are not followed, as a multiple of its own light:
                      ///< images between two mirrors that face each other go on without end
};

/// Light that reaches a mirror by chains that are not followed.
struct UnfollowedLight {
  std::vector<Point> corners;  ///< of the mirror, counter-clockwise from the side that reflects
  Spectrum exitance;           ///< W/m^2, after the reflection at this mirror and at later ones
};

/// Chains of planar mirrors and clear faces, those with the largest share first. The share is the fraction of a
/// source's flux that gets through the chain, for the best source. Each source sends a beam to a mirror, which the
/// outlines of the mirrors before it limit; occlusion is not considered.
struct MirrorChains {
  std::vector<MirrorChain> chains;
  std::vector<std::uint32_t> ranked;  ///< MirroredSource::id of the sources that were given, ascending
  std::vector<UnfollowedLight> unfollowed;
  double unfollowed_share = 0;  ///< its flux, relative to the flux that mirrors reflect straight from the sources
  bool is_cut = false;          ///< there are more chains than are followed
};

/// Up to 1,024 chains of up to most_mirrors, the product of whose reflectances is least_reflectance or more. Best-first
/// search over beams (Heckbert and Hanrahan 1984): a chain carries no more than the shorter one that it continues.
/// O(chains x mirrors x sources).
MirrorChains mirror_chains(const Scene& scene, std::span<const MirroredSource> sources);

}  // namespace patchlight
