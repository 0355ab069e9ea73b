#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

class Occluder;

/// How the radiosity of patches (rows) varies on them: the mean over each patch plus a plane.
struct Slopes {
  Field gradient;  ///< along the surface, W/m^2 per metre: three components of the first band, then those of the next
  Field left;      ///< how far the radiosity at a point may be from the plane, W/m^2, root mean square
};

/// Fitted to the differences from the patches of the same polygon side that share a vertex, by least squares; 0 where
/// there are none. Where one has more than twice the radiosity of the other and they do not see each other, a tenth of
/// their distance above the polygon, something stands between them, and they say nothing of each other. A plane that
/// would fall below 0 at a corner of its patch is made less steep. What is left is half of the residuals of the fit, at
/// the distance of a patch, or of all of the difference where there are too few patches for a residual; or what the
/// plane does not explain of `within`, how far points of each patch are known to be from its mean, root mean square
/// (empty: not known), where that is more. O(patches).
Slopes slopes_of(const PatchMesh& mesh, const FieldView& values, const Occluder& occluder, const Field& within);

}  // namespace patchlight
