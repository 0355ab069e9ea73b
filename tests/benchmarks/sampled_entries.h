#pragma once

#include "patchlight/transport/assemble.h"

#include "benchmarks/room.h"

#include <vector>

namespace patchlight::benchmarks {

/// A pair that shadow rays decided.
struct SampledEntry {
  PatchIndex first = 0;
  PatchIndex second = 0;
  double unoccluded = 0;    ///< exchange area without occluders, m^2
  bool is_partial = false;  ///< the rays disagreed: an estimate, else fully visible or fully occluded as far as seen
};

/// These pairs of an assembly that kept its errors, cluster by cluster as they were sampled.
std::vector<SampledEntry> sampled_entries(const Room& room, const Assembly& assembly);

}  // namespace patchlight::benchmarks
