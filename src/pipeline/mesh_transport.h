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

/// Rows and light in the colour of a run, as means over what is exposed of each patch.
RayTransportAndLight ray_light(const Run& run, const PatchMesh& mesh, ExchangeAndLight found);

/// Exchange areas S_ij = A_i F_ij of a mesh before closure; with rows on demand there are none.
struct RawTransport {
  Exchange exchange;
  TransportFacts facts;
  std::optional<Assembly> assembly;  ///< with error bars: the same exchange areas with the errors of their entries
  std::optional<RayTransportAndLight> by_rays;  ///< with rows of rays: in place of exchange areas
};

/// Light between the patches of a mesh: H = F B.
struct MeshTransport {
  std::unique_ptr<RowTransport> rows;  ///< null with rows of rays
  Eigen::VectorXd area;                ///< exposed, m^2
  TransportFacts facts;
  std::optional<Assembly> assembly;               ///< with error bars: exchange areas before closure
  std::optional<ClosedExchangeAreas> of_parents;  ///< with error bars: after closure, summed up over parents
  std::unique_ptr<RaysWithPockets> rays;          ///< with rows of rays, else null
  std::optional<RayLight> light;                  ///< with them, the light that goes with them
};

/// lit_problem() of a mesh with the exposed parts of its patches. \throws Cancelled.
LitProblem lit_problem(const Run& run, const MeshToSolve& meshed, const MeshTransport& transport);

/// All pairs, with visibility from shadow rays, unless Steps::exchange knows them; and the share of each patch's
/// hemisphere from which no patch is seen. With rows on demand (AssemblyOptions::storage) the lost shares alone: the
/// exchange areas are of no patch and the facts have neither row sums nor counts. With error bars exchange areas and
/// lost shares that are `known` are taken over; without them the rate of bare rays is measured. \throws Cancelled.
RawTransport raw_transport(const Run& run, const Plan& plan, const PatchMesh& mesh, const Known& known);

/// The same from rows of rays which are known.
RawTransport raw_transport(RayTransportAndLight by_rays);

/// The same after closure: each row sums up to what its patch sees. Without AssemblyOptions::close the rows are as they
/// were found. Rows on demand are not closed, either, whatever the plan says; their facts stay those of `raw`. The
/// mesh, and for rows on demand the run's tracing, have to outlive the transport. \throws Cancelled.
MeshTransport closed_transport(const Run& run, const Plan& plan, const NestedMesh& mesh, RawTransport raw);

}  // namespace patchlight
