#pragma once

#include "patchlight/scene/scene.h"

#include <Eigen/Geometry>
#include <vector>

namespace patchlight {

/// A side of a polygon that reflects light without scattering it: of a mirror, or of a clear polygon.
struct MirrorSide {
  PolygonIndex polygon = no_polygon;
  Side side = Side::front;
  Vector normal;  ///< unit, out of this side
  Point on_plane;
  double reflectance = 0;  ///< at most, over all bands; of a clear one that of light from all directions alike
};

/// Mirrors one after the other on the way from a receiver to a source, and what becomes of a receiver's place when it
/// is reflected at each of them: seen from the source the receiver is there, straight behind the last mirror.
struct MirrorChain {
  std::vector<MirrorSide> mirrors;
  double reflectance = 1;  ///< the product of theirs
  Eigen::Affine3d image = Eigen::Affine3d::Identity();
};

/// The chains that light can take over planar mirrors and clear faces, those that reflect most first: up to 16 mirrors
/// in a row, as long as the product of their reflectances is 1e-3 or more, 1,024 chains at most. Each mirror has
/// something before the plane of the next, and the other way round.
struct MirrorChains {
  std::vector<MirrorChain> chains;
  bool is_cut = false;  ///< there are more than that
  double cut_off = 0;   ///< where it is cut: the product of reflectances of the first that is left out
};
MirrorChains mirror_chains(const Scene& scene);

}  // namespace patchlight
