#include "output/rooms_part.h"

namespace patchlight {
namespace {

constexpr auto note_on_coarse =
    "min and uniformity of a surface that is coarse may be too high, as dark patches of it are larger than the cells "
    "of a "
    "grid by EN 12464-1, or points of them darker than their means. Sensors on a grid, which patchlight init writes "
    "for rooms, tell the values of the standard; smaller patches (mesh.patches) come nearer to them.";

}  // namespace

nlohmann::ordered_json rooms_part(const Report& report) {
  using Json = nlohmann::ordered_json;
  Json part;
  part["unit"] = report.unit;
  part["rooms"] = Json::array();
  for (const RoomLight& room : report.rooms) {
    Json entry;
    entry["name"] = room.name;
    for (const SurfaceLight& surface : room.surfaces) {
      if (surface.area == 0) continue;
      entry[name_of(surface.surface)] = {{"area_m2", surface.area},
                                         {"min", surface.min},
                                         {"mean", surface.mean},
                                         {"uniformity", surface.uniformity},
                                         {"coarse", surface.is_coarse}};
      if (surface.is_coarse) part["note"] = note_on_coarse;
    }
    part["rooms"].push_back(std::move(entry));
  }
  return part;
}

}  // namespace patchlight
