#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/transport_operator.h"

#include "transport/closure.h"
#include "visibility/occluder.h"

#include <Eigen/Core>
#include <memory>

namespace patchlight {

/// Transport with all exchange areas in memory: F_ij = S_ij / A_i, summed in double. `area` in m^2.
std::unique_ptr<RowTransport> dense_transport(ClosedExchangeAreas exchange_areas, Eigen::VectorXd area);

/// Transport that keeps no matrix: O(size) memory. Row i of the exchange areas is computed whenever it is asked for, in
/// O(size) time, and has the bits that assemble_exchange_areas() gives it with the same options; F_ij = S_ij / A_i with
/// `area` in m^2. gather() and form_factors() compute the rows of their receivers, shoot() those of its sources,
/// apply() all: O(size^2) time. Rows of neighbours that are asked for at once take less time than one by one. Closure
/// needs all rows at once, so these rows are as computed, and what they sum up to is off by the error of their entries.
/// The same bits for any number of threads.
///
/// Estimator::automatic only. `mesh` and `occluder` have to outlive the transport.
std::unique_ptr<RowTransport> on_demand_transport(const PatchMesh& mesh, const Occluder& occluder,
                                                  const AssemblyOptions& options, Eigen::VectorXd area);

}  // namespace patchlight
