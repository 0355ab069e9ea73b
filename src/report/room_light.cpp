#include "report/room_light.h"

#include "light/photometry.h"
#include "scene/room_body.h"
#include "scene/sensor_grid.h"
#include "scene/shells.h"
#include "scene/solids.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// The bodies of some models (gbXML) end at the inner sides of walls and ceilings whose faces stand in the middle of
// these: of a room that is not bounded all around, patches count as well that bound no room and face it from farther
// off, metres.
constexpr std::array<double, 5> farther_off = {0.1, 0.2, 0.3, 0.4, 0.5};
constexpr double bounded_all_around = 0.8;

// A patch bounds a room when the room is before it and not behind it: furniture stands in the room.
std::vector<PatchIndex> patches_at(const RoomBody& body, const PatchMesh& mesh) {
  std::vector<PatchIndex> found;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Vector step = body.step() * mesh.normal[i];
    if (body.holds(mesh.centroid[i] + step) && !body.holds(mesh.centroid[i] - step)) found.push_back(i);
  }
  return found;
}

bool is_bounded_all_around(const NamedRoom& room, const std::vector<PatchIndex>& patches, const PatchMesh& mesh) {
  double whole = 0;
  for (const std::vector<Point>& face : room.faces) whole += area_vector(face).norm();
  double bounded = 0;
  for (const PatchIndex i : patches) bounded += mesh.area[i];
  return bounded >= bounded_all_around * whole;
}

// Patches that are neither of a room nor stand in this one, and from whose centroids some point of it before them is in
// sight: the layers within a slab are not.
std::vector<PatchIndex> patches_farther_off(const RoomBody& body, const PatchMesh& mesh,
                                            const std::vector<char>& has_room, const Occluder& occluder) {
  const auto place_before = [&](PatchIndex i, double distance) -> Point {
    return mesh.centroid[i] + distance * mesh.normal[i];
  };
  std::vector<Segment> segments;
  std::vector<PatchIndex> patches;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (has_room[i] != 0 || body.holds(place_before(i, -body.step()))) continue;
    const auto* const nearest = std::find_if(farther_off.begin(), farther_off.end(),
                                             [&](double distance) { return body.holds(place_before(i, distance)); });
    if (nearest == farther_off.end()) continue;
    segments.push_back({mesh.centroid[i], place_before(i, *nearest), mesh.polygon[i], no_polygon});
    patches.push_back(i);
  }
  const std::vector<std::uint8_t> hidden = occluder.occluded(segments);
  std::vector<PatchIndex> found;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    if (hidden[k] == 0) found.push_back(patches[k]);
  }
  return found;
}

std::vector<RoomPatches> bounds_by_names(const Scene& scene, const PatchMesh& mesh) {
  const std::vector<NamedRoom>& rooms = scene.rooms;
  std::vector<RoomPatches> all;
  std::vector<char> has_room(mesh.size(), 0);
  for (const NamedRoom& room : rooms) {
    all.push_back({room.name, patches_at(RoomBody(room.faces), mesh)});
    for (const PatchIndex i : all.back().patches) has_room[i] = 1;
  }
  std::optional<Occluder> occluder;
  for (std::size_t k = 0; k < rooms.size(); ++k) {
    std::vector<PatchIndex>& patches = all[k].patches;
    if (is_bounded_all_around(rooms[k], patches, mesh)) continue;
    if (!occluder) occluder.emplace(scene, Occluder::Blockers::all);
    const std::vector<PatchIndex> others = patches_farther_off(RoomBody(rooms[k].faces), mesh, has_room, *occluder);
    patches.insert(patches.end(), others.begin(), others.end());
  }
  std::erase_if(all, [](const RoomPatches& bounds) { return bounds.patches.empty(); });
  return all;
}

// The closed shells that have patches on their inside, with these.
std::vector<RoomPatches> bounds_by_shells(const Scene& scene, const PatchMesh& mesh) {
  const Shells shells = shells_of(scene);
  constexpr std::size_t none = ~std::size_t{0};
  std::vector<std::size_t> of_side(2 * scene.polygons.size(), none);
  const std::vector<Solid> solids = closed_solids(scene, shells);
  for (std::size_t k = 0; k < solids.size(); ++k) {
    for (const PolygonIndex p : solids[k].polygons)
      of_side[std::size_t{2} * p + static_cast<std::size_t>(inner_side(solids[k], shells, p))] = k;
  }
  std::vector<RoomPatches> all(solids.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const std::size_t k = of_side[std::size_t{2} * mesh.polygon[i] + static_cast<std::size_t>(mesh.side[i])];
    if (k != none) all[k].patches.push_back(i);
  }
  std::erase_if(all, [](const RoomPatches& bounds) { return bounds.patches.empty(); });
  for (std::size_t k = 0; k < all.size(); ++k) all[k].name = all.size() == 1 ? "room" : "room " + std::to_string(k + 1);
  return all;
}

// Floors face up within 45 degrees, ceilings down; walls are all others.
RoomSurface surface_facing(const Vector& normal, const Vector& up) {
  const double steepest = std::sqrt(0.5);
  const double upward = normal.dot(up);
  return upward > steepest ? RoomSurface::floor : upward < -steepest ? RoomSurface::ceiling : RoomSurface::walls;
}

// A patch of a surface of a room.
struct LitPatch {
  double area = 0;     // m^2
  double value = 0;    // illuminance
  double differs = 0;  // how far it is from that at points, root mean square; 0 without error bars
};

// The cell of EN 12464-1 for a square of the area, of walls of a quarter of it, as a room has four.
double cell_of_grid(const SurfaceLight& surface) {
  const double side = std::sqrt(surface.surface == RoomSurface::walls ? surface.area / 4 : surface.area);
  return standard_spacing(side, side);
}

// May the illuminance be much lower at some points than the patches tell? The size of a patch is the root of its area:
// how light differs along a strip its display error tells.
bool is_coarse(const SurfaceLight& surface, const std::vector<LitPatch>& patches) {
  constexpr double much_lower = 0.9;
  constexpr double about_as_low = 2;
  const double cell = cell_of_grid(surface);
  return std::any_of(patches.begin(), patches.end(), [&](const LitPatch& patch) {
    if (!(patch.value < about_as_low * surface.min)) return false;
    return std::sqrt(patch.area) > cell || patch.value - patch.differs < much_lower * surface.min;
  });
}

SurfaceLight light_on(RoomSurface kind, const std::vector<LitPatch>& patches) {
  SurfaceLight surface{kind};
  if (patches.empty()) return surface;
  surface.min = patches[0].value;
  for (const LitPatch& patch : patches) {
    surface.area += patch.area;
    surface.mean += patch.area * patch.value;
    surface.min = std::min(surface.min, patch.value);
  }
  surface.mean /= surface.area;
  if (surface.mean > 0) surface.uniformity = surface.min / surface.mean;
  surface.is_coarse = is_coarse(surface, patches);
  return surface;
}

RoomLight light_of(const RoomPatches& bounds, const Scene& scene, const Simulation& simulation) {
  const double in_unit = scene.photometric ? 1 : 1 / luminous_efficacy;
  const Bands bands = bands_of(scene);
  const auto illuminance = [&](const Spectrum& irradiance) { return in_unit * luminance(irradiance, bands); };
  std::array<std::vector<LitPatch>, 3> surfaces;
  for (const PatchIndex i : bounds.patches) {
    const double area = simulation.problem.area[i];
    if (!(area > 0) || is_opening(scene, simulation.mesh.polygon[i])) continue;
    // Where no light at all comes nobody sees a surface: within a hollow wall that stands on the floor.
    if ((simulation.solution.irradiance.row(i) == 0).all()) continue;
    const auto surface = static_cast<std::size_t>(surface_facing(simulation.mesh.normal[i], scene.up));
    const double differs = simulation.error_bars ? illuminance(simulation.error_bars->display.row(i)) : 0;
    surfaces[surface].push_back({area, illuminance(simulation.solution.irradiance.row(i)), differs});
  }
  RoomLight light{bounds.name};
  for (const RoomSurface kind : {RoomSurface::floor, RoomSurface::walls, RoomSurface::ceiling}) {
    const auto k = static_cast<std::size_t>(kind);
    light.surfaces[k] = light_on(kind, surfaces[k]);
  }
  return light;
}

}  // namespace

std::vector<RoomPatches> rooms_of(const Scene& scene, const Simulation& simulation) {
  const PatchMesh& mesh = simulation.mesh;
  std::vector<RoomPatches> all = bounds_by_names(scene, mesh);
  if (all.empty()) all = bounds_by_shells(scene, mesh);
  if (!all.empty()) return all;
  const Eigen::VectorXd& enclosed = simulation.enclosed;
  const bool some = enclosed.size() > 0 && enclosed.maxCoeff() > 0;
  all.push_back({"room", {}});
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (!some || enclosed[i] > 0) all[0].patches.push_back(i);
  }
  return all;
}

std::vector<RoomLight> room_light(const Scene& scene, const Simulation& simulation) {
  std::vector<RoomLight> all;
  for (const RoomPatches& bounds : rooms_of(scene, simulation)) all.push_back(light_of(bounds, scene, simulation));
  std::erase_if(all, [](const RoomLight& light) {
    return std::all_of(light.surfaces.begin(), light.surfaces.end(), [](const SurfaceLight& s) { return s.area == 0; });
  });
  return all;
}

}  // namespace patchlight
