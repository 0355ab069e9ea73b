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

}  // namespace patchlight
