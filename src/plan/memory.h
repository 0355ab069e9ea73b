#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include <cstddef>
#include <string>

namespace patchlight {

/// What of the light takes memory: bands that differ, and rays that go on from mirrors and clear faces.
struct LightInMemory {
  bool in_colour = true;
  bool is_mirrored = true;
};

/// Bytes that solving takes at its peak, all in all: rather a little too many than too few. It follows from whether
/// form factors are kept, and their standard errors, too.
double memory_needed(std::size_t patches, const AssemblyOptions& assembly, const AccuracyOptions& accuracy,
                     const LightInMemory& light = {});

/// The same as it is planned.
double memory_needed(std::size_t patches, const Plan& plan);

/// True when a solution may be copied as well before its errors are known.
bool may_keep_solution(std::size_t patches, const Plan& plan);

/// Bytes that solving on a mesh of so many patches takes by rows of rays, with so many times the plan's rays, while the
/// mesh before is still there.
double memory_of_next_mesh(std::size_t patches, double times_the_rays, Plan plan);

/// True when that is usable.
bool fits_as_next_mesh(std::size_t patches, double times_the_rays, const Plan& plan);

/// Bytes that the run may take.
double usable_memory(const Resources& resources);

/// The largest number of patches for which memory_needed() is usable.
double patches_that_fit(const Plan& plan);

/// The least number of patches with edges up to so many metres.
std::size_t least_patches_with(const Scene& scene, const KeptSides& sides, double max_edge,
                               const ContactLines& contacts);

/// A number of bytes as messages have it: "1.25 GB".
std::string gigabytes(double bytes);

/// "takes 1.25 GB, and 1 GB may be taken (resources.memory)", as messages have what is not usable.
std::string memory_refused(double bytes, const Resources& resources);

/// Refuses what cannot fit before anything is meshed: by the number of patches asked for, or by the least number that
/// an edge allows, as a patch is never larger than the square of the longest edge. \throws MemoryError.
void require_memory(const Scene& scene, const Request& request, const Plan& plan);

/// \throws MemoryError when solving for so many patches would take more memory than it may.
void require_memory(std::size_t patches, const Request& request, const Plan& plan);

/// The same by rows of rays; Solver::cg, which takes a symmetric matrix, becomes gmres.
Request by_rays(Request request);

/// A plan that keeps all pairs made one that keeps rows of rays.
Plan by_rays(Plan plan);

/// A request with its storage decided.
struct ChosenStorage {
  Request request;
  Diagnostics notes;  ///< why, where it is rows of rays
};

/// What there is to be stored.
struct StoredLight {
  std::size_t patches = 0;
  std::size_t sides = 0;     ///< kept sides of polygons, which have the patches
  bool is_reflected = true;  ///< between them, more than once
  bool is_mirrored = false;  ///< also without being scattered, which is to be followed
  bool has_goal = false;     ///< patches and rays follow importance to a Goal
  bool has_sensors = false;  ///< whose standard errors follow from those of patches
};

/// Storage::automatic becomes rows of rays where light is mirrored, where there is a goal, where patches are more than
/// 10,000 or few on each side, and where pairs do not fit into the memory. It becomes tiles where there is a
/// part_that_takes_pairs(), or no light is reflected in either way. Another storage stays, except for rays where
/// error bars are requested of light that is not reflected: these become tiles. Rows of rays have error bars where
/// light is reflected, and with these nested meshes. Small meshes that have rays because of mirrors or of few patches a
/// side get more of them. Pairs have error bars where AccuracyOptions::cheap_error_bars allows them.
ChosenStorage choose_storage(const Request& request, const Given& given, const StoredLight& light);

}  // namespace patchlight
