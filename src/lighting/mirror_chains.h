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
  double light_share = 0;  ///< the share of the light that may meet it: by its area among these, or by the solid angle
                           ///< in which lamps and luminaires see it, of that around them, whichever is larger
};

/// Mirrors one after the other on the way from a receiver to a source, and what becomes of a receiver's place when it
/// is reflected at each of them: seen from the source the receiver is there, straight behind the last mirror.
struct MirrorChain {
  std::vector<MirrorSide> mirrors;
  double reflectance = 1;  ///< the product of theirs
  double light_share = 1;  ///< the least of theirs
  Eigen::Affine3d image = Eigen::Affine3d::Identity();
  double beyond = 0;  ///< chains that go on from it and are too long to be followed, as between two mirrors that face
                      ///< each other, bring so many times its own light, at most where each goes on over one mirror
};

/// The chains that light can take over planar mirrors and clear faces, those first by which most light may go,
/// reflectance times light_share: up to 16 mirrors in a row, as long as the product of their reflectances is 1e-3 or
/// more, and that with the share is 1e-3 or more of the largest; 1,024 chains at most. Each mirror has something before
/// the plane of the next, and the other way round. O(mirrors x lamps).
struct MirrorChains {
  std::vector<MirrorChain> chains;
  double left_out = 0;  ///< reflectance times light_share of the mirrors from which none of them goes straight to a
                        ///< light, of that of all
  bool is_cut = false;  ///< there are more of them than 1,024
};
MirrorChains mirror_chains(const Scene& scene);

}  // namespace patchlight
