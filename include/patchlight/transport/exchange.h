#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/half_differences.h"
#include "patchlight/transport/lost_share.h"

#include <Eigen/Core>
#include <string>

namespace patchlight {

class Occluder;
struct ClosedExchangeAreas;

/// The exchange between the patches of a mesh. Geometry alone decides it.
struct Exchange {
  ExchangeAreas exchange_areas{0};
  Eigen::VectorXd area;         ///< m^2, the exposed part of each patch: F_ij = S_ij / A_i
  Eigen::VectorXd raw_row_sum;  ///< sum_j F_ij before closure
  LostShare lost;
  AssemblyCounts counts;
  HalfDifferences half_differences;  ///< before closure, if requested or if closure weighs by them
  std::string closure;               ///< the method that closed the exchange areas; empty before closure
};

/// The exchange for rows on demand: exchange areas have no patches, and row sums are empty. Areas follow from the lost
/// shares alone. \throws Canceled.
Exchange exchange_on_demand(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            const Observer& observer = {});

/// Computes the exchange areas before closure, and the share of each patch's hemisphere in which no patch is visible.
/// \throws Canceled.
Exchange trace_exchange(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                        const Observer& observer = {});

/// The same from known exchange areas.
Exchange exchange_of(Assembly raw, const PatchMesh& mesh, LostShare lost);

/// True when closure weighs the entries by their errors: in an open scene with a limited number of patches.
bool weighs_by_errors(const LostShare& lost, PatchIndex patches);

/// Closes the exchange areas: the smallest change that makes each row sum to the visible share of its patch. Areas that
/// are already closed (Exchange::closure) stay. In a closed scene, storing closed rows as floats changes their sums by
/// less than 3e-7 of the area. That change becomes their remainder, of either sign; rows with larger defects are closed
/// again. \throws Canceled.
ClosedExchangeAreas close_exchange(Exchange exchange, const Observer& observer = {});

}  // namespace patchlight
