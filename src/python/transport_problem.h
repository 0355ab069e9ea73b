#pragma once

#include "patchlight/simulate.h"
#include "patchlight/transport/transport_operator.h"

#include <memory>

namespace patchlight {

/// Form factors between the patches of a scene, and the equations that are solved with them: B = E + R F B.
struct TransportProblem {
  std::shared_ptr<const Scene> scene;
  PatchMesh mesh;
  RadiosityProblem problem;
  Plan plan;
  std::shared_ptr<const Tracing> tracing;
  std::shared_ptr<const RowTransport> transport;
};

/// Per sensor of the scene (row) and patch the irradiance by a radiosity of 1 of that patch: its form factor with what
/// stands between, as sensors gather it. Not a number for sensors inside walls. \throws Cancelled.
Field sensor_factors(const TransportProblem& problem, const Observer& observer);

/// Traces and closes form factors, and keeps them. \throws InputError, MemoryError, Cancelled.
TransportProblem transport_problem(const std::shared_ptr<const Scene>& scene, const Request& request,
                                   const Observer& observer);

}  // namespace patchlight
