#include "verify/path_scene.h"

#include "base/streams.h"
#include "light/texture.h"
#include "scene/coverings.h"
#include "verify/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

// The panes of each material.
struct Panes {
  std::vector<std::vector<Pane>> panes;
  std::vector<Spectrum> nonspecular;
};

Panes panes_of_materials(const Scene& scene, Reflections reflections) {
  Panes all;
  for (const Material& material : scene.materials) {
    all.panes.push_back(panes_of(material.index, material.transmittance));
    all.nonspecular.push_back(hemispherical_nonspecular(all.panes.back(), reflections == Reflections::followed));
  }
  return all;
}

Surface surface_of(const Scene& scene, const Panes& panes, const std::pair<PolygonIndex, Side>& of,
                   const KeptSides& kept, Reflections reflections) {
  const auto [index, side] = of;
  const Polygon& polygon = scene.polygons[index];
  const MaterialIndex of_material = material_on(polygon, side);
  const Material& material = scene.materials[of_material];
  const bool is_front = side == Side::front;
  Surface surface;
  surface.kept = (is_front ? kept.front : kept.back)[index] != 0;
  surface.normal = is_front ? front_normal(scene, index) : Vector(-front_normal(scene, index));
  surface.reflectance = material.reflectance;
  if (const TextureMap* map = texture_map_on(scene, polygon, side)) {
    surface.texture = material.texture;
    surface.texture_map = *map;
  }
  surface.panes = panes.panes[of_material];
  surface.nonspecular = panes.nonspecular[of_material];
  if (!surface.panes.empty()) surface.reflectance = surface.reflectance.min(surface.nonspecular);
  surface.reflections = reflections;
  surface.is_clear = is_opening(scene, index);
  surface.is_specular = surface.is_clear || is_mirror(scene, index, Side::front) || is_mirror(scene, index, Side::back);
  const bool is_mirrored = reflections == Reflections::followed && !surface.is_clear && is_mirror(scene, index, side);
  surface.mirrored =
      is_mirrored ? material.specular_reflectance : Spectrum(Spectrum::Zero(material.reflectance.size()));
  const bool both_kept = kept.front[index] != 0 && kept.back[index] != 0;
  surface.scattered_through = both_kept && is_sheet(scene, index)
                                  ? material.diffuse_transmittance
                                  : Spectrum(Spectrum::Zero(material.reflectance.size()));
  const bool emits = surface.kept && (is_front || polygon.back_material || kept.emit_from_back);
  surface.exitance = emits ? material.exitance : Spectrum(Spectrum::Zero(material.exitance.size()));
  return surface;
}

Surfaces surfaces_of(const Scene& scene, const KeptSides& kept, Reflections reflections) {
  const Panes panes = panes_of_materials(scene, reflections);
  Surfaces surfaces;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back})
      surfaces.sides.push_back(surface_of(scene, panes, {p, side}, kept, reflections));
  }
  return surfaces;
}

bool scatters(const Surface& surface) {
  return (surface.reflectance > 0).any() || (surface.exitance > 0).any() || (surface.scattered_through > 0).any();
}

}  // namespace

Spectrum reflectance_at(const Surface& surface, const Point& point) {
  if (!surface.texture) return surface.reflectance;
  return reflectance_at(*surface.texture, surface.texture_map.linear * point + surface.texture_map.offset).min(1);
}

Spectrum transmittance(const Surface& surface, double cosine) {
  if (surface.panes.empty()) return Spectrum::Zero(surface.reflectance.size());
  return transmittance(surface.panes, std::min(1.0, std::abs(cosine)));
}

Spectrum specular_reflectance(const Surface& surface, double cosine) {
  if (surface.panes.empty() || surface.reflections == Reflections::kept) return surface.mirrored;
  return specular_reflectance(surface.panes, std::min(1.0, std::abs(cosine)));
}

Spectrum nonspecular_profile(const Surface& surface, double cosine) {
  if (surface.panes.empty()) return Spectrum::Ones(surface.reflectance.size());
  const Spectrum onward = transmittance(surface, cosine) + specular_reflectance(surface, cosine);
  return onward.unaryExpr(&nonspecular_rest) / surface.nonspecular;
}

Eigen::Matrix3d frame_around(const Vector& normal) {
  const Vector tangent = normal.unitOrthogonal();
  Eigen::Matrix3d frame;
  frame << tangent, normal.cross(tangent), normal;
  return frame;
}

PathScene::PathScene(const Scene& scene, const KeptSides& sides, Reflections reflections)
    : tracing_(scene, find_coverings(scene, sides), Occluder::Blockers::all, reflections),
      faces_(tracing_.all_faces()),
      surfaces_(surfaces_of(scene, sides, reflections)),
      opaque_(tracing_.opaque_faces()),
      clear_(tracing_.clear_faces()),
      bounds_(patchlight::bounds(scene)),
      polygons_(scene.polygons.size()),
      bands_(number_of_bands(scene)) {}

Field PathScene::transmittance(std::span<const Segment> segments) const {
  const auto blocked = opaque_->occluded(segments);
  const auto crosses_pane = clear_ ? clear_->occluded(segments) : std::vector<std::uint8_t>(segments.size(), 0);
  Field share(static_cast<Eigen::Index>(segments.size()), bands_);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    auto row = share.row(static_cast<Eigen::Index>(k));
    if (blocked[k] != 0)
      row = 0.0;
    else if (crosses_pane[k] == 0)
      row = 1.0;
    else
      row = through_panes(segments[k]);
  }
  return share;
}

// A straight line crosses each clear polygon once at most, so the loop ends.
Spectrum PathScene::through_panes(const Segment& segment) const {
  Spectrum share = Spectrum::Ones(bands_);
  const Vector way = segment.to - segment.from;
  const double length = way.norm();
  double travelled = 0;
  Ray ray{segment.from, way / length, segment.from_polygon};
  for (std::size_t crossed = 0; crossed < polygons_; ++crossed) {
    const std::optional<Hit> hit = clear_->first_hits({&ray, 1}).front();
    if (!hit || travelled + hit->distance >= length || hit->polygon == segment.to_polygon) break;
    const Surface& surface = surfaces_.at(hit->polygon, hit->side);
    share *= patchlight::transmittance(surface, surface.normal.dot(ray.direction));
    travelled += hit->distance;
    ray.origin = hit->point;
    ray.from_polygon = hit->polygon;
  }
  return share;
}

Point PathScene::beyond(const Point& from, const Vector& direction) const {
  return from + (extent() + (from - bounds_.center()).norm()) * direction;
}

RayEnd walk_to_end(const PathScene& scene, std::optional<Hit> hit, const Vector& direction, std::uint32_t seed) {
  RayEnd end{std::move(hit), direction, Spectrum::Ones(scene.bands())};
  // Rays between ideal mirrors may never end.
  for (std::uint64_t meeting = 0; end.hit && meeting < 4096; ++meeting) {
    const Hit met = *end.hit;
    const Surface& surface = scene.surfaces().at(met.polygon, met.side);
    if (!surface.is_specular) break;
    const double cosine = surface.normal.dot(met.direction);
    const Spectrum through = transmittance(surface, cosine);
    const Spectrum mirrored = specular_reflectance(surface, cosine);
    // Where nothing is scattered, the first four meetings reduce the weight; from then on a ray may end.
    const bool may_end = scatters(surface) || meeting >= 4;
    const double ends = may_end ? std::max(0.0, 1 - through.mean() - mirrored.mean()) : 0;
    const double sum = through.mean() + mirrored.mean() + ends;
    const double drawn = sum * uniform({seed, meeting, stream::pane_or_reflection});
    if (drawn >= through.mean() + mirrored.mean()) {
      end.factor *= ends > 0 ? Spectrum(nonspecular_profile(surface, cosine) * (sum / ends))
                             : Spectrum(Spectrum::Zero(scene.bands()));
      break;
    }
    const bool is_mirrored = drawn >= through.mean();
    end.factor *= (is_mirrored ? mirrored / mirrored.mean() : through / through.mean()) * sum;
    if (is_mirrored) end.direction = mirrored_direction(surface.normal, end.direction);
    const Ray onward{met.point, end.direction, met.polygon};
    end.hit = scene.faces().first_hits({&onward, 1}).front();
    if (!end.hit) break;
    end.hit->distance += met.distance;
    end.hit->reflections = met.reflections + (is_mirrored ? 1 : 0);
  }
  return end;
}

namespace {

constexpr std::uint32_t rays_per_point = 8;

struct VisibilityTest {
  const Occluder& occluder;
  const Surfaces& surfaces;
  const PathReceiver& receiver;
  Vector normal;
  Eigen::Matrix3d frame;
  double reach;  // meters within which a face lies against the receiver: 1e-5 of the scene's extent

  bool looks_out(const Ray& ray) const;
  std::vector<Ray> rays_from(const Point& point, std::uint32_t seed) const;
};

// True when the ray meets a kept side, or gets into the open.
bool VisibilityTest::looks_out(const Ray& ray) const {
  const auto hit = occluder.first_hits({&ray, 1}).front();
  if (hit) return surfaces.at(hit->polygon, hit->side).kept;
  // A face in the receiver's plane is met only from a little behind.
  Ray from_behind = ray;
  from_behind.origin -= reach * normal;
  const auto second = occluder.first_hits({&from_behind, 1}).front();
  if (!second || second->distance * ray.direction.dot(normal) >= 2 * reach) return true;
  // The receiver may lie over the face: then the ray meets it from behind.
  const Side other = second->side == Side::front ? Side::back : Side::front;
  return occluder.lies_over(receiver.polygon, second->polygon, other);
}

std::vector<Ray> VisibilityTest::rays_from(const Point& point, std::uint32_t seed) const {
  std::vector<Ray> rays;
  for (const auto& u : scrambled_sobol(rays_per_point, seed)) {
    rays.push_back({point, frame * square_to_cosine_hemisphere(u[0], u[1]), receiver.polygon});
  }
  for (std::uint32_t k = 0; k < rays_per_point; ++k) {
    const double azimuth = 2 * std::numbers::pi * k / rays_per_point;
    const Vector direction = Vector(std::cos(azimuth), std::sin(azimuth), 1e-3).normalized();
    rays.push_back({point, frame * direction, receiver.polygon});
  }
  return rays;
}

}  // namespace

std::vector<std::uint8_t> exposed(const Occluder& occluder, const Surfaces& surfaces, const PathReceiver& receiver,
                                  std::span<const Point> points, std::uint64_t seed) {
  const Vector normal = surfaces.at(receiver.polygon, receiver.side).normal;
  const VisibilityTest visibility{
      occluder, surfaces, receiver, normal, frame_around(normal), 1e-5 / occluder.frame().scale};
  std::vector<std::uint8_t> result;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const bool under_another = occluder.is_covered(receiver.polygon, receiver.side, points[k]);
    const std::vector<Ray> rays = visibility.rays_from(points[k], hash({seed, k}));
    const auto looks_out = [&](const Ray& ray) { return visibility.looks_out(ray); };
    result.push_back(!under_another && std::any_of(rays.begin(), rays.end(), looks_out) ? 1 : 0);
  }
  return result;
}

}  // namespace patchlight
