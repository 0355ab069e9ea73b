#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

/// Means over the patches of `mesh` of a field that is constant on every patch of `other`, one row per patch of
/// `other`: sum_k O_ik x_k / sum_k O_ik, where O_ik is the area in which two patches overlap. Both meshes are of the
/// same sides of the same polygons; either may be the finer one. Where parts of patches are covered, the mean over what
/// is exposed is average_over(share x) / average_over(share). The same bits for any number of threads. Costs about n +
/// n' log n' + n sqrt(n') per side of a polygon.
Field average_over(const PatchMesh& mesh, const PatchMesh& other, const FieldView& values);

/// A field that is linear on every patch.
struct SlopedField {
  Field values;  ///< the means of the patches
  Field slopes;  ///< three columns for each of `values`: the gradient, per metre
};

/// A field with the slopes that the means of the patches around show, by least squares; patches around are those of the
/// same polygon side that share a corner. No corner gets a value beyond those of the patches around (Barth and
/// Jespersen, AIAA 89-0366): what is not negative stays so.
SlopedField with_slopes(const PatchMesh& mesh, const FieldView& values);

/// The same means of a field that is linear on every patch of `other`. So they do not depend on how the patches of both
/// meshes lie to each other, but by the field's curvature.
Field average_over(const PatchMesh& mesh, const PatchMesh& other, const SlopedField& field);

}  // namespace patchlight
