#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

/// The gradients of a field of patch means along the surface, per metre: for each patch (row) the three components of
/// the first band, then those of the next. Fitted to the differences from the patches of the same polygon side that
/// share a vertex, by least squares; 0 where there are none.
Field gradients(const PatchMesh& mesh, const FieldView& values);

}  // namespace patchlight
