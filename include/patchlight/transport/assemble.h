#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/sampling_error.h"

#include <cstdint>
#include <vector>

namespace patchlight {

class Occluder;

/// How exchange areas are found. All but the first are for study: they take no short cuts, and every pair that faces
/// each other costs rays.
enum class Estimator {
  automatic,      ///< closed forms, and shadow rays where something may be in between
  area,           ///< from random points of one patch to random points of the other
  point_polygon,  ///< from random points of the smaller patch, each with the exact form factor to the larger one
  hemisphere,     ///< rays from each patch over its hemisphere, counted where they arrive
  contour         ///< the contour integral times the visible share of the samples of `area`
};

/// The estimator's name as on the command line.
const char* name_of(Estimator estimator);

/// How the exchange areas of all pairs of patches are kept.
enum class Storage {
  automatic,  ///< tiles, or rays where make_plan() prefers them, docs/concepts/pairs-and-rays.md
  tiles,      ///< each pair once, as floats: time and memory in proportion to the square of the patches
  rays,  ///< not as pairs: sparse rows of the patches that some rays from each meet. Time and memory in proportion to
         ///< the patches, and an error that more rays make smaller
  on_demand  ///< not at all: a row is computed whenever a solver asks for it. Memory in proportion to the patches
};

/// The storage's name as on the command line.
const char* name_of(Storage storage);

/// True when the entries of all pairs are kept, so that they can be closed, summed up and written.
constexpr bool keeps_entries(Storage storage) { return storage == Storage::tiles || storage == Storage::automatic; }

/// Short cuts of the automatic estimator, each of which can be left out to measure its saving and its error;
/// docs/theory/occluded-form-factors.md.
struct ShortCuts {
  bool hidden = true;  ///< clusters that one polygon hides from each other take no rays
  bool free = true;    ///< clusters with nothing between them take no rays
  bool far = true;     ///< far pairs take the quadrature of the lowest order
};

/// How form factors are found, and how they are kept. Assembling all pairs takes the first five.
struct AssemblyOptions {
  int samples = 8;  ///< shadow rays of a pair that rays decide. The automatic estimator rounds them up to an even
                    ///< number and takes sampling_effort() times as many; powers of two fill packets of rays best. The
                    ///< others take just this many for every pair, Estimator::hemisphere for every patch
  std::uint64_t seed = 1;
  bool keep_errors = false;  ///< fill Assembly::entry_errors; the automatic estimator only
  Estimator estimator = Estimator::automatic;
  ShortCuts short_cuts = {};             ///< of the automatic estimator
  bool close = true;                     ///< correct the form factors so that rows sum up to what is seen
  Storage storage = Storage::automatic;  ///< with rows on demand form factors are not closed
  int lost_share_rays = 256;             ///< hemisphere rays per patch
  int rays = 64;  ///< with Storage::rays: of a patch over its hemisphere, in the mean; those towards lamps and bright
                  ///< patches grow with them
};

/// The number to raise where the sampling errs too much: rays of a patch, or shadow rays of a pair.
constexpr int samples_of(const AssemblyOptions& assembly) {
  return assembly.storage == Storage::rays ? assembly.rays : assembly.samples;
}

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

  AssemblyCounts& operator+=(const AssemblyCounts& other);
};

/// Exchange areas as computed, before closure, and their known errors.
struct Assembly {
  ExchangeAreas exchange_areas;
  AssemblyCounts counts;
  SamplingError error;
  EntryErrors entry_errors;  ///< when asked for
};

/// The entries of some pairs that are known already, from another mesh of the same scene and with the same options.
struct KnownEntries {
  const Assembly& assembly;
  std::vector<PatchIndex> place;  ///< of each patch of the new mesh: the same patch in the other one, or no_patch
};

/// Exchange areas of all pairs of patches, before closure. Symmetric by construction, zero on the diagonal and between
/// patches of one plane, with the automatic estimator and Estimator::contour never more than the unoccluded value. The
/// same bits for any number of threads. O(size^2) time. \throws Cancelled.
Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options = {},
                                 const Observer& observer = {});

/// The same with the automatic estimator, but pairs of patches that are both known are taken as they are: what
/// assembling all would give, but for rounding, as clusters differ. Standard errors of known pairs stay, the sampling
/// error is pooled over both meshes. Cost and counts are those of the others.
Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                 const KnownEntries& known, const Observer& observer = {});

}  // namespace patchlight
