#pragma once

#include "patchlight/simulate.h"

namespace patchlight {

/// A solution with what its error bars need, as long as it is there.
struct SolvedScene {
  const Simulation& simulation;
  const RowTransport& transport;
  const EntryErrors& entry_errors;
};

/// The error bars of a simulation whose mesh is the refinement of one with edges twice as long; that one is solved for
/// them. \throws Cancelled.
ErrorBars error_bars(const Scene& scene, const Request& request, const SolvedScene& solved, const Observer& observer);

}  // namespace patchlight
