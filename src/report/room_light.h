#pragma once

#include "patchlight/report/report.h"

#include <string>
#include <vector>

namespace patchlight {

/// The patches that bound a room.
struct RoomPatches {
  std::string name;
  std::vector<PatchIndex> patches;
};

/// Rooms are those that the models name. Without names they are the closed shells with patches on their inside. Without
/// such shells one "room" has all enclosed patches, or all patches. O(patches x corners of the rooms).
std::vector<RoomPatches> rooms_of(const Scene& scene, const Simulation& simulation);

}  // namespace patchlight
