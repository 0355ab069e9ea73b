#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/lost_share.h"
#include "patchlight/transport/sampling_error.h"

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
  SamplingError error;       ///< of the sampled entries, before closure
  EntryErrors entry_errors;  ///< of the exchange areas before closure, when asked for or when closure weighs by them
  std::string closure;       ///< the method that has closed the exchange areas; empty before closure
};

/// What is known of the exchange without exchange areas, which are computed on demand: those in the result are of no
/// patch, and row sums are empty. Areas have nothing but the lost shares to go by. \throws Cancelled.
Exchange exchange_on_demand(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            const Observer& observer = {});

/// Exchange areas before closure, and the share of each patch's hemisphere from which no patch is seen.
/// \throws Cancelled.
Exchange trace_exchange(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                        const Observer& observer = {});

/// The same from exchange areas that are known.
Exchange exchange_of(Assembly raw, const PatchMesh& mesh, LostShare lost);

/// True when closure weighs the entries by their errors: in an open scene of not too many patches.
bool weighs_by_errors(const LostShare& lost, PatchIndex patches);

/// Changes the exchange areas least so that each row sums up to what its patch sees: all of its hemisphere less the
/// lost share. Those that are closed already (Exchange::closure) stay; in a closed scene what the storage of closed
/// rows as floats has changed of their sums, below 3e-7 of the area, becomes their remainder, of either sign, and rows
/// that are farther off are closed again. \throws Cancelled.
ClosedExchangeAreas close_exchange(Exchange exchange, const Observer& observer = {});

}  // namespace patchlight
