#pragma once

#include "patchlight/transport/assemble.h"

#include "benchmarks/room.h"
#include "benchmarks/sampled_entries.h"
#include "visibility/occluder.h"

#include <vector>

namespace patchlight::benchmarks {

/// The packets of shadow rays that an assembly traces for a part of its pairs, as evenly spread as possible: at most
/// `packets` of them. `sampled` are the pairs that rays decided, in the assembly's order. Adjacent pairs, of which
/// there are few, are left out.
std::vector<ShadowPacket> shadow_packets(const Room& room, const TracingFrame& frame, const AssemblyOptions& options,
                                         const std::vector<SampledEntry>& sampled, std::size_t packets);

}  // namespace patchlight::benchmarks
