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
  bool emits_from_back = false;
  std::shared_ptr<const RowTransport> transport;
};

/// Traces and closes form factors, and keeps them. \throws InputError, MemoryError, Cancelled.
TransportProblem transport_problem(std::shared_ptr<const Scene> scene, const Request& request,
                                   const Observer& observer);

}  // namespace patchlight
