#pragma once

#include "patchlight/transport/transport_operator.h"

#include "mesh/nested_mesh.h"
#include "pipeline/exchange_and_light.h"
#include "pipeline/run.h"
#include "solve/pockets.h"
#include "transport/closure.h"

#include <memory>
#include <optional>

namespace patchlight {

struct RayTransportAndLight {
  TracedRows rows;
  RayLight light;
};

/// Rows and light in the color of a run, as means over the exposed part of each patch.
RayTransportAndLight ray_light(const Run& run, const PatchMesh& mesh, ExchangeAndLight found);

/// Exchange areas S_ij = A_i F_ij of a mesh before closure; empty for rows on demand.
struct RawTransport {
  Exchange exchange;
  TransportFacts facts;
  std::optional<Assembly> assembly;  ///< with error bars: the same exchange areas with the errors of their entries
  std::optional<RayTransportAndLight> by_rays;  ///< with rows of rays: in place of exchange areas
};

/// Light between the patches of a mesh: H = F B.
struct MeshTransport {
  std::shared_ptr<RowTransport> rows;  ///< null with rows of rays
  Eigen::VectorXd area;                ///< exposed, m^2
  TransportFacts facts;
  std::optional<Assembly> assembly;               ///< with error bars: exchange areas before closure
  std::optional<ClosedExchangeAreas> of_parents;  ///< with error bars: after closure, summed over parents
  std::shared_ptr<RaysWithPockets> rays;          ///< with rows of rays, else null
  std::optional<RayLight> light;                  ///< with rows of rays, the light of RayLight
};

/// lit_problem() of a mesh with the exposed parts of its patches. \throws Canceled.
LitProblem lit_problem(const Run& run, const MeshToSolve& meshed, const MeshTransport& transport);

/// Computes the exchange areas of all pairs, with visibility from shadow rays, unless Steps::exchange gives them. Also
/// computes the share of each patch's hemisphere in which no patch is visible. With rows on demand
/// (AssemblyOptions::storage) only lost shares are computed: the exchange areas have no patches, and the facts neither
/// row sums nor counts. With error bars, `known` exchange areas and lost shares are reused; without, the rate of bare
/// rays is measured. \throws Canceled.
RawTransport raw_transport(const Run& run, const Plan& plan, const PatchMesh& mesh, const Known& known);

/// The same from known rows of rays.
RawTransport raw_transport(RayTransportAndLight by_rays);

/// The transport after closure: each row sums to the visible share of its patch. Rows stay unchanged without
/// AssemblyOptions::close, and rows on demand in any case; their facts are those of `raw`. The mesh must outlive the
/// transport, and for rows on demand the run's tracing, too. \throws Canceled.
MeshTransport closed_transport(const Run& run, const Plan& plan, const NestedMesh& mesh, RawTransport raw);

}  // namespace patchlight
