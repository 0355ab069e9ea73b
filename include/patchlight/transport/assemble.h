#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/sampling_error.h"
#include "patchlight/visibility/occluder.h"

#include <cstdint>
#include <vector>

namespace patchlight {

struct AssemblyOptions {
  int probes = 4;    ///< shadow rays of a pair before it counts as fully visible or fully blocked
  int samples = 16;  ///< shadow rays of a partly occluded pair, at least `probes`; adjacent pairs take four
                     ///< times as many. Both are rounded up to 2, 4, 8 or a multiple of 16, to fill packets
  std::uint64_t seed = 1;
  bool keep_sampled = false;  ///< fill Assembly::sampled: 16 bytes for each pair that shadow rays decided
};

/// How the entries of a matrix came about.
struct AssemblyCounts {
  std::uint64_t facing_pairs = 0;   ///< pairs that face each other: the entries that are not zero by orientation
  std::uint64_t near_pairs = 0;     ///< of these, closer than two diameters: closed form
  std::uint64_t hidden_pairs = 0;   ///< pairs of patches that one polygon hides from each other with all around them: 0
                                    ///< without a look at them; not among the others
  std::uint64_t free_pairs = 0;     ///< of these, those between which nothing can stand: no shadow ray
  std::uint64_t partial_pairs = 0;  ///< of these, partly occluded: Monte Carlo
  std::uint64_t blocked_pairs = 0;  ///< of these, fully occluded
  std::uint64_t shadow_rays = 0;
};

/// A pair that shadow rays decided.
struct SampledEntry {
  PatchIndex first = 0;
  PatchIndex second = 0;
  float unoccluded = 0;  ///< exchange area without occluders, m^2; -1 where all rays were blocked and it was not found
  bool is_partial = false;  ///< the probes disagreed: an estimate, else fully visible or fully occluded as far as seen
};

struct Assembly {
  ExchangeAreas exchange_areas;
  AssemblyCounts counts;
  SamplingError error;
  std::vector<SampledEntry> sampled;  ///< when asked for
};

/// Exchange areas of all pairs of patches, before closure. Symmetric by construction, zero on the diagonal and between
/// patches of one plane, never more than the unoccluded value. The same bits for any number of threads. O(size^2) time.
/// \throws Cancelled.
Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options = {},
                                 const Observer& observer = {});

}  // namespace patchlight
