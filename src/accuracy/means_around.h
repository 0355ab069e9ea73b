#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

/// Root mean squares over the patches of the same polygon side that share a vertex with a patch, itself among them.
Field means_around(const PatchMesh& mesh, const FieldView& values);

}  // namespace patchlight
