#include "output/rooms_part.h"

namespace patchlight {

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
      entry[name_of(surface.surface)] = {
          {"area_m2", surface.area}, {"min", surface.min}, {"mean", surface.mean}, {"uniformity", surface.uniformity}};
    }
    part["rooms"].push_back(std::move(entry));
  }
  return part;
}

}  // namespace patchlight
