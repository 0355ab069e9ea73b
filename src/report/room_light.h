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

/// What floor, walls and ceiling of each room get. Rooms are those that the models name; where they name none, closed
/// shells with patches on their inside; where there are none of these either, one "room" of all enclosed patches, or of
/// all. What stands in rooms of the first two kinds has no part; neither have clear faces, patches that no light
/// reaches, and rooms without others. O(patches x corners of the rooms).
std::vector<RoomLight> room_light(const Scene& scene, const Simulation& simulation);

}  // namespace patchlight
