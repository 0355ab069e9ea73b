#pragma once

#include "patchlight/base/field.h"
#include "patchlight/gather/gather.h"
#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

class Occluder;

/// How the radiosity of patches (rows) varies on them: the mean over each patch plus a plane.
struct Slopes {
  Field gradient;  ///< along the surface, W/m^2 per metre: three components of the first band, then those of the next
  Field residual;  ///< an allowance for how far the radiosity at a point is from the plane where it is curved, W/m^2
  Field unknown;   ///< how far from it is what the plane does not explain at all, root mean square, W/m^2
};

/// Fitted to the differences from the patches of the same polygon side that share a vertex, by least squares; 0 where
/// there are none. Where one of two patches has a quarter more than the other and they do not see each other, a tenth
/// of their distance above the polygon, something stands between them, and they say nothing of each other. A plane
/// that would fall below 0 at a corner of its patch is made less steep.
///
/// The residual is half of that at the centroids of the patches around, or of all of the difference where these are
/// too few for a residual. Unknown is what the plane does not explain of `errors.display`, or, where that is not known
/// and a polygon side has no more than four patches, all that these reflect: nothing tells how that varies. O(patches)
/// with a bounded number around each vertex. \throws Cancelled.
Slopes slopes_of(const PatchMesh& mesh, const FieldView& values, const Occluder& occluder,
                 const RadiosityErrors& errors, const Observer& observer);

}  // namespace patchlight
