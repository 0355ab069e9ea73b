#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include <cstddef>
#include <string>

namespace patchlight {

/// The properties of the light that need memory: different bands, and rays that continue from mirrors and clear faces.
struct LightInMemory {
  bool in_colour = true;
  bool is_mirrored = true;
};

/// Peak memory of a solve in bytes, rather a little too high than too low. Depends on whether form factors and their
/// standard errors are kept.
double memory_needed(std::size_t patches, const AssemblyOptions& assembly, const AccuracyOptions& accuracy,
                     const LightInMemory& light = {});

/// The same for a plan.
double memory_needed(std::size_t patches, const Plan& plan);

/// True when memory also has room for a copy of a solution before its errors are computed.
bool may_keep_solution(std::size_t patches, const Plan& plan);

/// Bytes that the ray method needs on a mesh of `patches` patches with `times_the_rays` times the plan's rays, while
/// the previous mesh is still in memory.
double memory_of_next_mesh(std::size_t patches, double times_the_rays, Plan plan);

/// True when memory_of_next_mesh() is within the usable memory.
bool fits_as_next_mesh(std::size_t patches, double times_the_rays, const Plan& plan);

/// Bytes that the run may take.
double usable_memory(const Resources& resources);

/// The largest number of patches whose memory_needed() is within the usable memory.
double patches_that_fit(const Plan& plan);

/// The smallest number of patches with edges of at most `max_edge` meters.
std::size_t least_patches_with(const Scene& scene, const KeptSides& sides, double max_edge,
                               const ContactLines& contacts);

/// A number of bytes for messages: "1.25 GB".
std::string gigabytes(double bytes);

/// The part of a message for a run that needs too much memory: "takes 1.25 GB, and 1 GB is allowed (resources.memory)".
std::string memory_refused(double bytes, const Resources& resources);

/// Rejects a run that cannot fit before anything is meshed: by the requested number of patches, or by the smallest
/// number that an edge length allows. A patch is never larger than the square of the longest edge. \throws MemoryError.
void require_memory(const Scene& scene, const Request& request, const Plan& plan);

/// \throws MemoryError when solving for `patches` patches would exceed the usable memory.
void require_memory(std::size_t patches, const Request& request, const Plan& plan);

/// The same request by the ray method. Solver::cg, which needs a symmetric matrix, becomes gmres.
Request by_rays(Request request);

/// Converts a plan of the pair method into one of the ray method.
Plan by_rays(Plan plan);

/// A request with its storage decided.
struct ChosenStorage {
  Request request;
  Diagnostics notes;  ///< the reason, if it is rows of rays
};

/// The facts that decide how the exchange of light is stored.
struct StoredLight {
  std::size_t patches = 0;
  std::size_t sides = 0;     ///< kept sides of polygons, on which the patches lie
  bool is_reflected = true;  ///< between patches, more than once
  bool is_mirrored = false;  ///< light is also mirrored, and rays follow it
  bool has_goal = false;     ///< patches and rays follow importance to a Goal
  bool has_sensors = false;  ///< whose standard errors follow from those of patches
};

/// Replaces Storage::automatic. It becomes rows of rays where light is mirrored, where there is a goal, above 10,000
/// patches, with few patches on each side, or where pairs do not fit into memory. It becomes tiles where there is a
/// part_that_takes_pairs(), or where no light is reflected in either way. Another storage stays, with one exception:
/// rays become tiles when error bars are requested of light that is not reflected.
///
/// Rows of rays have error bars, and then nested meshes, where light is reflected. Small meshes that use rays because
/// of mirrors or few patches per side get more rays. Pairs have error bars where AccuracyOptions::cheap_error_bars
/// allows them.
ChosenStorage choose_storage(const Request& request, const Given& given, const StoredLight& light);

}  // namespace patchlight
