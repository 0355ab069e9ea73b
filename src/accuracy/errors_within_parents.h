#pragma once

#include "accuracy/errors.h"
#include "mesh/nested_mesh.h"
#include "transport/ray_transport.h"

namespace patchlight {

/// What mesh_errors() tells of pairs, for rows of rays: F (B_h - B_2h), where B_2h = E + R P F B_2h is the solution on
/// the parents, P the mean over each. B_h - B_2h = (1 - P) B + R e, where the mean irradiance of parents is off by
/// e = P F (1 - P) B + P F R e: how the light of a parent's patches differs is known to the patches, and is in the
/// error only as far as it gets to other parents. So the error of the irradiance of each patch, W/m^2, is F (1 - P) B +
/// F R e by Richardson's extrapolation. Twice, F (1 - P) B by either half of the rays: the product has little bias by
/// their noise, and its mean over the patches around has less of it; of both the larger, as in mesh_errors(). Zero
/// where no parent is cut.
Field errors_within_parents(const NestedMesh& mesh, const RayTransport& transport, const SolvedProblem& solved);

}  // namespace patchlight
