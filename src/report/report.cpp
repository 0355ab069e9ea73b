#include "patchlight/report/report.h"

#include "accuracy/errors.h"
#include "light/photometry.h"
#include "report/room_light.h"
#include "scene/room_body.h"
#include "scene/sensor_grid.h"
#include "scene/solids.h"
#include "solve/scattering.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

// In some models (gbXML) room bodies end at the inner sides of walls, but the faces stand in the middle of the walls. A
// room that is not bounded all around therefore also gets patches that face it from these distances, meters, and bound
// no other room.
constexpr std::array<double, 5> farther_off = {0.1, 0.2, 0.3, 0.4, 0.5};

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
  return bounded >= 0.8 * whole;
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
std::vector<RoomPatches> bounds_by_shells(const Scene& scene, const Simulation& simulation) {
  const PatchMesh& mesh = simulation.mesh;
  const std::shared_ptr<const SceneGeometry> geometry = geometry_of(scene, simulation.plan.sides);
  const std::size_t none = ~std::size_t{0};
  std::vector<std::size_t> of_side(2 * scene.polygons.size(), none);
  const std::vector<Solid>& solids = geometry->solids;
  for (std::size_t k = 0; k < solids.size(); ++k) {
    for (const PolygonIndex p : solids[k].polygons)
      of_side[std::size_t{2} * p + static_cast<std::size_t>(inner_side(solids[k], geometry->shells, p))] = k;
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

// True when the illuminance may be much lower, by a tenth, at some points than the patches show. Only patches that are
// less than twice as bright as the darkest matter. The size of a patch is the root of its area.
bool is_coarse(const SurfaceLight& surface, const std::vector<LitPatch>& patches) {
  const double cell = cell_of_grid(surface);
  return std::any_of(patches.begin(), patches.end(), [&](const LitPatch& patch) {
    if (!(patch.value < 2 * surface.min)) return false;
    return std::sqrt(patch.area) > cell || patch.value - patch.differs < 0.9 * surface.min;
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

// The light on floor, walls and ceiling of each of rooms_of(). Furniture in rooms with names or of shells does not
// count, nor do clear faces, patches that no light reaches, and rooms without other patches.
std::vector<RoomLight> room_light(const Scene& scene, const Simulation& simulation) {
  std::vector<RoomLight> all;
  for (const RoomPatches& bounds : rooms_of(scene, simulation)) all.push_back(light_of(bounds, scene, simulation));
  std::erase_if(all, [](const RoomLight& light) {
    return std::all_of(light.surfaces.begin(), light.surfaces.end(), [](const SurfaceLight& s) { return s.area == 0; });
  });
  return all;
}

std::optional<double> ray_error(const Simulation& simulation) {
  if (simulation.ray_standard_error.size() == 0) return std::nullopt;
  return relative_bar(simulation.ray_standard_error, simulation.problem, simulation.solution,
                      Eigen::VectorXd::Ones(simulation.ray_standard_error.rows()));
}

SceneFacts scene_facts(const Scene& scene) {
  return {.file = scene.file,
          .sha256 = scene.sha256,
          .polygons = scene.polygons.size(),
          .materials = scene.materials.size(),
          .luminaires = scene.luminaires,
          .metres_per_unit = scene.metres_per_unit,
          .up = scene.up,
          .up_stated = scene.up_stated,
          .size = bounds(scene).diagonal(),
          .warnings = chosen(scene.diagnostics, makes_results_wrong),
          .notes = remarks_of(scene),
          .bands = bands_of(scene)};
}

std::vector<MaterialLight> material_light(const Scene& scene, const Simulation& simulation) {
  const Field& irradiance = simulation.solution.irradiance;
  const Field absorbed = absorb(simulation.problem.scattering, irradiance);
  const Spectrum zero = Spectrum::Zero(irradiance.cols());
  const Spectrum infinite = Spectrum::Constant(irradiance.cols(), std::numeric_limits<double>::infinity());
  std::vector<MaterialLight> all;
  for (const Material& material : scene.materials) {
    all.push_back({.name = material.name,
                   .reflectance = material.reflectance,
                   .exitance = material.exitance,
                   .emitted = zero,
                   .absorbed = zero,
                   .lowest = infinite,
                   .mean = zero,
                   .highest = -infinite,
                   .radiance = zero});
  }
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    MaterialLight& of_material = all[simulation.mesh.material[i]];
    const double area = simulation.problem.area[i];
    of_material.area += area;
    of_material.emitted += area * simulation.problem.exitance.row(i);
    of_material.mean += area * irradiance.row(i);
    of_material.radiance += area / std::numbers::pi * simulation.solution.radiosity.row(i);  // L = B / pi
    of_material.absorbed += area * absorbed.row(i);
    of_material.lowest = of_material.lowest.min(irradiance.row(i));
    of_material.highest = of_material.highest.max(irradiance.row(i));
  }
  for (MaterialLight& of_material : all) {
    of_material.mean /= of_material.area;
    of_material.radiance /= of_material.area;
  }
  return all;
}

std::optional<RowSumFacts> row_sum_facts(const Eigen::VectorXd& row_sum, const Simulation& simulation) {
  if (row_sum.size() == 0) return {};
  const Eigen::ArrayXd& area = simulation.problem.area.array();
  const Eigen::ArrayXd defect = (row_sum - expected_row_sum(simulation.transport.lost)).array();
  return RowSumFacts{.min = row_sum.minCoeff(),
                     .mean = (area * row_sum.array()).sum() / area.sum(),
                     .max = row_sum.maxCoeff(),
                     .rms_defect = std::sqrt((area * defect.square()).sum() / area.sum())};
}

std::vector<WorstPatch> worst_patches(const Scene& scene, const Simulation& simulation) {
  const PatchMesh& mesh = simulation.mesh;
  std::vector<WorstPatch> worst;
  for (const RowDefect& row :
       worst_rows(simulation.transport.raw_row_sum, simulation.transport.lost, simulation.problem.area, 5)) {
    const Polygon& polygon = scene.polygons[mesh.polygon[row.patch]];
    worst.push_back({.patch = row.patch,
                     .place = place_of(scene, polygon),
                     .face = polygon.face,
                     .group = group_name(scene, polygon.group),
                     .material = scene.materials[mesh.material[row.patch]].name,
                     .centre = mesh.centroid[row.patch],
                     .area = simulation.problem.area[row.patch],
                     .row_sum = row.row_sum,
                     .expected = row.expected});
  }
  return worst;
}

double seconds_of(const std::vector<StageCost>& costs, Stage stage) {
  double seconds = 0;
  for (const StageCost& cost : costs) seconds += cost.stage == stage ? cost.seconds : 0;
  return seconds;
}

FormFactorFacts form_factor_facts(const Scene& scene, const Simulation& simulation) {
  const TransportFacts& transport = simulation.transport;
  const Eigen::VectorXd& area = simulation.problem.area;
  FormFactorFacts facts;
  if (keeps_entries(simulation.plan.assembly.storage)) facts.counts = transport.counts;
  const double seconds = seconds_of(simulation.costs, Stage::form_factors);
  if (seconds > 0) facts.rays_per_second = static_cast<double>(transport.counts.shadow_rays) / seconds;
  facts.bare_rays_per_second = transport.bare_rays_per_second;
  facts.lost_share_rays = static_cast<std::uint64_t>(rays_of_patches(transport.lost, simulation.mesh.size()).sum());
  facts.ray_error = ray_error(simulation);
  facts.closure = transport.closure;
  facts.raw_row_sum = row_sum_facts(transport.raw_row_sum, simulation);
  facts.row_sum = row_sum_facts(transport.row_sum, simulation);
  facts.worst = worst_patches(scene, simulation);
  facts.escaped = area.dot(transport.lost.escaped) / area.sum();
  facts.at_backs = area.dot(transport.lost.at_backs) / area.sum();
  return facts;
}

bool stopped_by_rows(const Simulation& simulation) {
  const SolverOptions& options = simulation.plan.solver;
  const Solution& solution = simulation.solution;
  if (solution.converged || solution.stopped || !solution.trapped.empty() || solution.history.empty()) return false;
  const auto shots = static_cast<double>(solution.history.back().number);
  return options.max_rows && shots < static_cast<double>(options.max_iterations) * simulation.mesh.size();
}

SolutionFacts solution_facts(const Simulation& simulation) {
  const Solution& solution = simulation.solution;
  return {.converged = solution.converged,
          .trapped = solution.trapped,
          .patch_bound = solution.patch_bound,
          .history = solution.history,
          .highest_reflectance = simulation.problem.scattering.reflectance.maxCoeff(),
          .stopped_by_rows = stopped_by_rows(simulation),
          .unfinished = simulation.unfinished};
}

}  // namespace

std::vector<RoomPatches> rooms_of(const Scene& scene, const Simulation& simulation) {
  const PatchMesh& mesh = simulation.mesh;
  std::vector<RoomPatches> all = bounds_by_names(scene, mesh);
  if (all.empty()) all = bounds_by_shells(scene, simulation);
  if (!all.empty()) return all;
  const Eigen::VectorXd& enclosed = simulation.enclosed;
  const bool some = enclosed.size() > 0 && enclosed.maxCoeff() > 0;
  all.push_back({"room", {}});
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (!some || enclosed[i] > 0) all[0].patches.push_back(i);
  }
  return all;
}

const char* name_of(RoomSurface surface) {
  switch (surface) {
    case RoomSurface::floor:
      return "floor";
    case RoomSurface::walls:
      return "walls";
    case RoomSurface::ceiling:
      return "ceiling";
  }
  return "";
}

SensorFacts sensor_facts(std::span<const SensorGroup> groups, const Readings& readings, Diagnostics warnings) {
  return {.groups = by_group(groups, readings),
          .unit = sensor_unit(readings),
          .daylight = readings.outside_by_sky.has_value(),
          .warnings = std::move(warnings)};
}

Report report_of(const Scene& scene, const Request& request, const Simulation& simulation, SensorFacts sensors) {
  return {.scene = scene_facts(scene),
          .request = request,
          .plan = simulation.plan,
          .notes = simulation.notes,
          .patches = simulation.mesh.size(),
          .vertices = simulation.mesh.vertices.size(),
          .area = simulation.problem.area.sum(),
          .materials = material_light(scene, simulation),
          .rooms = room_light(scene, simulation),
          .unit = scene.photometric ? "lx" : "W/m^2",
          .sensors = std::move(sensors),
          .form_factors = form_factor_facts(scene, simulation),
          .balance = simulation.balance,
          .solution = solution_facts(simulation),
          .accuracy = simulation.accuracy,
          .spaces = simulation.spaces,
          .costs = simulation.costs};
}

bool is_accurate(const Report& report) {
  const std::optional<double>& asked = report.plan.accuracy.relative_error;
  return !asked || (!report.accuracy.empty() && report.accuracy.back().total <= *asked);
}

}  // namespace patchlight
