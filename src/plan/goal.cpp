#include "plan/goal.h"

#include "accuracy/errors.h"
#include "accuracy/spaces.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "base/vectors.h"
#include "mesh/nested_mesh.h"
#include "plan/survey.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// The width of a rectangle with the area of a polygon, as long as its bounds; of a thin strip 1/256 of that length, so
// that its patches stay few.
double width_of(const Scene& scene, PolygonIndex polygon) {
  Box box;
  for (const Point& corner : corner_points(scene, polygon)) box.extend(corner);
  const double length = box.diagonal().norm();
  return std::max(polygon_area(scene, polygon) / length, length / 256);
}

// Some patches on each large polygon, and at least one on each other.
PatchMesh coarse_mesh(const Scene& scene, const KeptSides& sides) {
  const double usual = std::sqrt(kept_area(scene, sides) / 2000);
  std::vector<double> coarsest;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) coarsest.push_back(0.5 * width_of(scene, p));
  return tessellate(scene, sides, {usual, std::move(coarsest)});
}

// Marks the polygons that have a side with such patches. A side with less than a quarter of its area in an enclosed
// space belongs to the surroundings, e.g. the ground below a house.
std::vector<std::uint8_t> polygons_with(const Eigen::VectorXd& enclosed, const PatchMesh& mesh) {
  std::vector<std::uint8_t> is_goal(mesh.first_patch.size() / 2, 0);
  for (PolygonIndex p = 0; p < is_goal.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      const auto [begin, end] = mesh.patches_on(p, side);
      double all = 0;
      double inside = 0;
      for (PatchIndex i = begin; i < end; ++i) all += mesh.area[i], inside += enclosed[i] * mesh.area[i];
      if (inside > 0 && inside >= 0.25 * all) is_goal[p] = 1;
    }
  }
  return is_goal;
}

// A particle of importance on its way.
struct Particle {
  Ray ray;
  bool has_left = false;  // it has met the surroundings
};

// The places where particles start: the patches of the goal by their area, and the sensors, which take a half.
class Sources {
 public:
  Sources(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& goal) : mesh_(mesh) {
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      if (goal[i] == 0) continue;
      patches_.push_back(i);
      area_before_.push_back(area_);
      area_ += mesh.area[i];
    }
    sensors_ = all_sensors(scene.sensors);
  }

  Particle at(const std::array<double, 4>& u) const {
    if (!sensors_.empty() && u[0] < 0.5) {
      const auto k =
          std::min(sensors_.size() - 1, static_cast<std::size_t>(2 * u[0] * static_cast<double>(sensors_.size())));
      return {{sensors_[k].point, cosine_direction(sensors_[k].normal, u[1], u[2]), no_polygon}};
    }
    const double place = sensors_.empty() ? u[0] : 2 * u[0] - 1;
    const auto next = std::upper_bound(area_before_.begin(), area_before_.end(), place * area_);
    const auto k = static_cast<std::size_t>(next - area_before_.begin()) - 1;
    const PatchIndex i = patches_[k];
    const double rest = std::clamp((place * area_ - area_before_[k]) / mesh_.area[i], 0.0, 1.0);
    return {{square_to_quad(mesh_.corner_points(i).points, rest, u[3]), cosine_direction(mesh_.normal[i], u[1], u[2]),
             mesh_.polygon[i]}};
  }

 private:
  const PatchMesh& mesh_;
  std::vector<PatchIndex> patches_;
  std::vector<double> area_before_;
  double area_ = 0;
  std::vector<Sensor> sensors_;
};

double mean_of(const Spectrum& spectrum) { return spectrum.size() > 0 ? spectrum.mean() : 0; }

// How a polygon scatters particles. Mirrors scatter like matt faces, because importance steers effort alone.
struct Scatterer {
  Vector front;
  bool is_goal = false;
  bool is_opening = false;
  std::array<double, 2> reflected = {};    // shares, per side: front, back
  std::array<double, 2> transmitted = {};  // likewise
};

std::vector<Scatterer> scatterers_of(const Scene& scene, const std::vector<std::uint8_t>& is_goal) {
  std::vector<Scatterer> all;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    Scatterer face{front_normal(scene, p), is_goal[p] != 0, is_opening(scene, p)};
    for (const Side side : {Side::front, Side::back}) {
      const Material& material = scene.materials[material_on(scene.polygons[p], side)];
      const auto s = static_cast<std::size_t>(side);
      face.reflected[s] = mean_of(material.reflectance) + mean_of(material.specular_reflectance);
      face.transmitted[s] = mean_of(material.diffuse_transmittance);
    }
    all.push_back(face);
  }
  return all;
}

// The particle after a hit, or none where it is absorbed.
std::optional<Particle> scattered(const Scatterer& face, const Hit& hit, const Particle& before, std::uint32_t key) {
  const auto uniform = [&](std::uint32_t k) { return (hash({key, k}) + 0.5) * 0x1p-32; };
  if (face.is_opening) return Particle{{hit.point, before.ray.direction, hit.polygon}, before.has_left};
  const auto side = static_cast<std::size_t>(hit.side);
  const double drawn = uniform(0);
  if (drawn >= face.reflected[side] + face.transmitted[side]) return {};
  const bool leaves_front = (hit.side == Side::front) == (drawn < face.reflected[side]);
  const Vector direction = cosine_direction(leaves_front ? face.front : Vector(-face.front), uniform(1), uniform(2));
  return Particle{{hit.point, direction, hit.polygon}, before.has_left || !face.is_goal};
}

// Particles that arrive in the surroundings, and the number that leave the scene without meeting these.
struct Arrived {
  std::vector<ImportanceHit> hits;
  double reflected = 0;  // sum of the reflectances where they arrive
  std::size_t escaped = 0;
};

void trace_batch(const Occluder& faces, const std::vector<Scatterer>& scatterers, std::vector<Particle> particles,
                 std::uint32_t seed, Arrived& arrived) {
  for (std::uint32_t bounce = 0; bounce < 16 && !particles.empty(); ++bounce) {
    std::vector<Ray> rays;
    for (const Particle& particle : particles) rays.push_back(particle.ray);
    const auto hits = faces.first_hits(rays);
    std::vector<Particle> next;
    for (std::size_t k = 0; k < hits.size(); ++k) {
      if (!hits[k]) {
        arrived.escaped += particles[k].has_left ? 0 : 1;
        continue;
      }
      const Hit& hit = *hits[k];
      const Scatterer& face = scatterers[hit.polygon];
      if (!face.is_goal && !face.is_opening) {
        arrived.reflected += face.reflected[static_cast<std::size_t>(hit.side)];
        arrived.hits.push_back({{hit.polygon, hit.side, hit.point}, hit.distance > 0 ? 1 / hit.distance : 0});
      }
      const std::uint32_t key = hash({seed, bounce, k});
      if (auto particle = scattered(face, hit, particles[k], key)) next.push_back(*particle);
    }
    particles = std::move(next);
  }
}

// Particles start in batches, until enough of them have arrived in the surroundings, or many batches have started.
Arrived trace_importance(const Scene& scene, const Occluder& faces, const std::vector<std::uint8_t>& is_goal,
                         const Sources& sources, std::uint64_t seed) {
  const std::vector<Scatterer> scatterers = scatterers_of(scene, is_goal);
  Arrived arrived;
  for (std::uint32_t batch = 0; batch < 12 && arrived.hits.size() < 1 << 13; ++batch) {
    const std::uint32_t key = hash({seed, batch, stream::goal_batch});
    std::vector<Particle> particles;
    for (const auto& u : scrambled_sobol(1 << 14, key)) particles.push_back(sources.at(u));
    trace_batch(faces, scatterers, std::move(particles), key, arrived);
  }
  return arrived;
}

std::vector<PatchIndex> patches_of(const std::vector<ImportanceHit>& hits, const PatchMesh& mesh) {
  std::vector<SidePoint> places;
  for (const ImportanceHit& hit : hits) places.push_back(hit.at);
  return PatchLookup(mesh).patches_at(places);
}

// The importance of each patch, and whether it has enough hits to compare its parts. With fewer hits the parts share
// the importance equally, since their own hits would be noise.
struct PatchImportance {
  std::vector<double> of_patch;
  std::vector<std::uint8_t> has_many_hits;
};

PatchImportance importance_of(const PatchMesh& mesh, const std::vector<ImportanceHit>& hits) {
  PatchImportance found{std::vector<double>(mesh.size(), 0), {}};
  std::vector<double> number(mesh.size(), 0);
  const std::vector<PatchIndex> met = patches_of(hits, mesh);
  for (std::size_t k = 0; k < met.size(); ++k) {
    if (met[k] == no_patch) continue;
    const double size = std::sqrt(mesh.area[met[k]]);
    number[met[k]] += 1;
    found.of_patch[met[k]] += std::pow(std::min(1.0, size * hits[k].closeness), mesh_order);
  }
  for (const double n : number) found.has_many_hits.push_back(n >= 8 ? 1 : 0);
  return found;
}

// The importance of the patches of a refined mesh.
PatchImportance importance_after(const PatchImportance& before, const Refinement& refined,
                                 const std::vector<ImportanceHit>& hits) {
  const double left = std::pow(0.5, mesh_order) / 4;
  PatchImportance now = importance_of(refined.mesh, hits);
  std::vector<int> parts(before.of_patch.size(), 0);
  for (const PatchIndex parent : refined.parent) ++parts[parent];
  for (PatchIndex i = 0; i < refined.mesh.size(); ++i) {
    const PatchIndex parent = refined.parent[i];
    if (before.has_many_hits[parent] != 0) continue;
    now.of_patch[i] = before.of_patch[parent] * (parts[parent] > 1 ? left : 1);
    now.has_many_hits[i] = 0;
  }
  return now;
}

}  // namespace

std::shared_ptr<const Goal> find_goal(const Scene& scene, const KeptSides& sides, const Coverings& coverings,
                                      const std::vector<std::string>& interest, std::uint64_t seed) {
  if ((!scene.sky && !scene.sun) || !(kept_area(scene, sides) > 0)) return {};

  // 1. The polygons of enclosed spaces, and those that are named.
  const PatchMesh mesh = coarse_mesh(scene, sides);
  const Occluder faces(scene, Occluder::Blockers::all, coverings);
  const Eigen::VectorXd enclosed = enclosed_patches(scene, faces, mesh);
  const Eigen::VectorXd named = interest_of(scene, sides, mesh, interest, enclosed);
  if (total(enclosed) == 0 || total(named) == 0) return {};
  Goal goal{polygons_with(enclosed.cwiseMax(named), mesh), {}, 0, 0};
  double around = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    (goal.is_goal[mesh.polygon[i]] != 0 ? goal.goal_area : around) += mesh.area[i];
  if (around == 0 || goal.goal_area == 0) return {};

  // 2. Importance of the surroundings.
  Arrived arrived = trace_importance(scene, faces, goal.is_goal, Sources(scene, mesh, named), seed);
  goal.hits = std::move(arrived.hits);

  // 3. Light of one brightness comes from the open, and the surroundings reflect their part of it. So light in the goal
  //    is to that outside as (escaped + reflected) to the particles, and effort is shared as importance times light is.
  const double sum = static_cast<double>(arrived.escaped) + 2 * arrived.reflected;
  goal.share_of_surroundings = sum > 0 ? arrived.reflected / sum : 0;
  return std::make_shared<const Goal>(std::move(goal));
}

KeptSides sides_of_goal(const KeptSides& sides, const Goal* goal) {
  KeptSides kept = sides;
  if (goal == nullptr) return kept;
  for (std::size_t p = 0; p < goal->is_goal.size(); ++p)
    if (goal->is_goal[p] == 0) kept.front[p] = kept.back[p] = 0;
  return kept;
}

PatchEdges edges_for(const Scene& scene, double max_edge, const Goal* goal) {
  if (goal == nullptr) return max_edge;
  std::vector<double> coarsest(scene.polygons.size(), 0);
  for (PolygonIndex p = 0; p < coarsest.size(); ++p)
    if (goal->is_goal[p] == 0) coarsest[p] = 2 * width_of(scene, p);
  return {max_edge, std::move(coarsest)};
}

PatchMesh cut_by_importance(PatchMesh mesh, const Goal& goal, std::size_t patches) {
  const auto is_around = [&](const PatchMesh& of, PatchIndex i) { return goal.is_goal[of.polygon[i]] == 0; };
  PatchImportance importance = importance_of(mesh, goal.hits);
  // The cuts come on top of the patches that the outlines of faces take, which may be many.
  for (PatchIndex i = 0; i < mesh.size(); ++i) patches += is_around(mesh, i) ? 1 : 0;
  for (;;) {
    std::size_t count = 0;
    std::vector<PatchIndex> order;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      count += is_around(mesh, i) ? 1 : 0;
      if (is_around(mesh, i) && importance.of_patch[i] > 0) order.push_back(i);
    }
    if (count >= patches || order.empty()) return mesh;

    // The most important ones, down to a quarter of the first, each of which becomes four.
    std::stable_sort(order.begin(), order.end(),
                     [&](PatchIndex a, PatchIndex b) { return importance.of_patch[a] > importance.of_patch[b]; });
    const double least = importance.of_patch[order.front()] / 4;
    std::vector<std::uint8_t> is_cut(mesh.size(), 0);
    for (std::size_t k = 0; k < order.size() && importance.of_patch[order[k]] >= least && count + 3 * k < patches; ++k)
      is_cut[order[k]] = 1;
    Refinement refined = refine(mesh, is_cut);
    importance = importance_after(importance, refined, goal.hits);
    mesh = std::move(refined.mesh);
  }
}

double mean_area_of_goal(const PatchMesh& mesh, const Goal* goal) {
  std::vector<double> areas;
  for (PatchIndex i = 0; goal != nullptr && i < mesh.size(); ++i)
    if (goal->is_goal[mesh.polygon[i]] != 0) areas.push_back(mesh.area[i]);
  return areas.empty() ? mean_area(mesh) : mean_area(areas);
}

std::vector<double> important_areas(const PatchMesh& mesh, const Goal* goal) {
  if (goal == nullptr || goal->share_of_surroundings == 0) return mesh.area;
  std::vector<double> hits(mesh.size(), 0.5);  // patches that none has met by chance count as well
  for (const PatchIndex i : patches_of(goal->hits, mesh))
    if (i != no_patch) hits[i] += 1;
  const auto is_around = [&](PatchIndex i) { return goal->is_goal[mesh.polygon[i]] == 0; };
  const double all = static_cast<double>(goal->hits.size()) + 0.5 * mesh.size();
  const double of_hit = goal->goal_area * goal->share_of_surroundings / (1 - goal->share_of_surroundings) / all;
  std::vector<double> areas = mesh.area;
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    if (is_around(i)) areas[i] = hits[i] * of_hit;
  return areas;
}

}  // namespace patchlight
