#pragma once

#include "accuracy/errors.h"
#include "mesh/nested_mesh.h"
#include "transport/ray_transport.h"

namespace patchlight {

/// What mesh_errors() tells of pairs, for rows of rays: B_h - B_2h is (1 - P) B_h, where P takes the means over
/// parents, and what that comes to through all reflections. So the error of the irradiance of each patch, W/m^2, is
/// F (1 - P) B followed through these, by Richardson's extrapolation. Twice, first by either half of the rays: their
/// product has little bias by their noise, and its mean over the patches around has less of it. Zero where no parent is
/// cut.
Field errors_within_parents(const NestedMesh& mesh, const RayTransport& transport, const SolvedProblem& solved);

}  // namespace patchlight
