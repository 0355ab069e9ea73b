#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/half_differences.h"

#include <cstdint>
#include <vector>

namespace patchlight {

class Occluder;

/// How exchange areas are computed. All but the first are for study: they use no shortcuts, and every facing pair costs
/// rays.
enum class Estimator {
  automatic,      ///< closed forms, and shadow rays where something may block the view
  area,           ///< from random points of one patch to random points of the other
  point_polygon,  ///< from random points of the smaller patch, each with the exact form factor to the larger one
  hemisphere,     ///< rays from each patch over its hemisphere, counted at the patches that they hit
  contour         ///< the contour integral times the visible share of the samples of `area`
};

/// The estimator's name as on the command line.
const char* name_of(Estimator estimator);

/// How the exchange areas of all pairs of patches are stored.
enum class Storage {
  automatic,  ///< tiles, or rays where make_plan() prefers them, docs/concepts/pairs-and-rays.md
  tiles,      ///< each pair once, as floats: time and memory grow with the square of the number of patches
  rays,       ///< sparse rows: the patches that a few rays from each patch hit. Time and memory are proportional to the
              ///< number of patches; more rays reduce the error
  on_demand   ///< not stored: a row is computed whenever a solver needs it. Memory is proportional to the number of
              ///< patches
};

/// The storage's name as on the command line.
const char* name_of(Storage storage);

/// True when the entries of all pairs are stored, so that they can be closed, summed and written.
constexpr bool keeps_entries(Storage storage) { return storage == Storage::tiles || storage == Storage::automatic; }

/// Shortcuts of the automatic estimator. Each can be disabled to measure its saving and its error;
/// docs/theory/occluded-form-factors.md.
struct ShortCuts {
  bool hidden = true;  ///< clusters that one polygon hides from each other take no rays
  bool free = true;    ///< clusters with nothing between them take no rays
  bool far = true;     ///< far pairs use the quadrature of the lowest order
};

/// How form factors are computed and stored. Assembling all pairs uses the first five.
struct AssemblyOptions {
  int samples = 8;  ///< shadow rays per sampled pair. The automatic estimator rounds the number up to an even one and
                    ///< multiplies it by sampling_effort(); powers of two fill packets of rays best. The other
                    ///< estimators use exactly this number per pair, Estimator::hemisphere per patch
  std::uint64_t seed = 1;
  bool keep_errors = false;  ///< fill Assembly::half_differences; the automatic estimator only
  Estimator estimator = Estimator::automatic;
  ShortCuts short_cuts = {};             ///< of the automatic estimator
  bool close = true;                     ///< correct the form factors so that each row sums to the visible share
  Storage storage = Storage::automatic;  ///< rows on demand are not closed
  int lost_share_rays = 256;             ///< hemisphere rays per patch
  int rays = 64;  ///< with Storage::rays: mean number of hemisphere rays per patch; rays towards lamps and bright
                  ///< patches grow with it
};

/// The number to increase if sampling noise is too large: rays per patch, or shadow rays per pair.
constexpr int samples_of(const AssemblyOptions& assembly) {
  return assembly.storage == Storage::rays ? assembly.rays : assembly.samples;
}

/// How the entries of a matrix were computed.
struct AssemblyCounts {
  std::uint64_t facing_pairs = 0;   ///< pairs that face each other: the entries that are not zero by orientation
  std::uint64_t near_pairs = 0;     ///< of these, closer than two diameters: closed form
  std::uint64_t hidden_pairs = 0;   ///< pairs in clusters that one polygon hides from each other: 0 without examining
                                    ///< them; not included in the other counts
  std::uint64_t free_pairs = 0;     ///< of these, those between which nothing can stand: no shadow ray
  std::uint64_t partial_pairs = 0;  ///< of these, partly occluded: Monte Carlo
  std::uint64_t blocked_pairs = 0;  ///< of these, fully occluded
  std::uint64_t shadow_rays = 0;

  AssemblyCounts& operator+=(const AssemblyCounts& other);
};

/// Exchange areas as computed, before closure, and their sampling errors.
struct Assembly {
  ExchangeAreas exchange_areas;
  AssemblyCounts counts;
  HalfDifferences half_differences;  ///< when asked for
};

/// Known entries of some pairs, from another mesh of the same scene with the same options.
struct KnownEntries {
  const Assembly& assembly;
  std::vector<PatchIndex> place;  ///< per patch of the new mesh: the same patch in the other mesh, or no_patch
};

/// Computes the exchange areas of all pairs of patches, before closure. Symmetric by construction, zero on the diagonal
/// and between patches of one plane. With the automatic estimator and Estimator::contour, never above the unoccluded
/// value. The same bits for any number of threads. O(size^2) time. \throws Canceled.
Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options = {},
                                 const Observer& observer = {});

/// The same with the automatic estimator, but entries between two known patches are copied. The result equals a full
/// assembly up to rounding, as clusters differ. Cost and counts include the other pairs only.
Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                 const KnownEntries& known, const Observer& observer = {});

}  // namespace patchlight
