#include "lighting/light_paths.h"

#include "scene/specular_faces.h"

#include <algorithm>

namespace patchlight {

PaneSides::PaneSides(const Scene& scene) : bands_(number_of_bands(scene)) {
  for (const Material& material : scene.materials) {
    panes_.push_back(panes_of(material));
    mirrors_.push_back(material.specular_reflectance);
  }
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const bool is_clear = is_opening(scene, p);
    const bool is_specular = is_clear || is_mirror(scene, p, Side::front) || is_mirror(scene, p, Side::back);
    if (!is_specular) continue;
    if (sides_.empty()) sides_.resize(scene.polygons.size());
    const Polygon& polygon = scene.polygons[p];
    sides_[p] = {front_normal(scene, p),
                 {material_on(polygon, Side::front), material_on(polygon, Side::back)},
                 is_clear,
                 is_specular};
  }
}

// Light meets a front against its normal.
MaterialIndex PaneSides::material_met(const Sides& sides, const Vector& direction) const {
  return sides.materials[sides.normal.dot(direction) < 0 ? 0 : 1];
}

Spectrum PaneSides::transmittance(PolygonIndex polygon, const Vector& direction) const {
  const Sides& sides = sides_[polygon];
  const std::vector<Pane>& panes = panes_[material_met(sides, direction)];
  if (panes.empty()) return Spectrum::Zero(bands_);
  return patchlight::transmittance(panes, cosine_between(sides.normal, direction));
}

Spectrum PaneSides::specular_reflectance(PolygonIndex polygon, const Vector& direction) const {
  const Sides& sides = sides_[polygon];
  const MaterialIndex met = material_met(sides, direction);
  const std::vector<Pane>& panes = panes_[met];
  if (sides.is_clear && !panes.empty())
    return patchlight::specular_reflectance(panes, cosine_between(sides.normal, direction));
  return !sides.is_clear && mirrors_[met].size() > 0 ? mirrors_[met] : Spectrum(Spectrum::Zero(bands_));
}

LightPaths::LightPaths(const Scene& scene, const Tracing& tracing)
    : bounds_(bounds(scene)), opaque_(tracing.opaque_faces()), clear_(tracing.clear_faces()), panes_(scene) {}

Field LightPaths::transmittance(std::span<const Segment> segments) const {
  const auto blocked = opaque_->occluded(segments);
  const auto meets_opening = clear_ ? clear_->occluded(segments) : std::vector<std::uint8_t>(segments.size(), 0);
  Field share(static_cast<Eigen::Index>(segments.size()), panes_.bands());
  for (std::size_t k = 0; k < segments.size(); ++k) {
    auto row = share.row(static_cast<Eigen::Index>(k));
    if (meets_opening[k] && !blocked[k])
      row = through_openings(segments[k]).transmittance;
    else
      row = blocked[k] ? 0.0 : 1.0;
  }
  return share;
}

std::vector<Passage> LightPaths::passages(std::span<const Segment> segments) const {
  const auto blocked = opaque_->occluded(segments);
  std::vector<Passage> found(segments.size());
  std::vector<Segment> free;
  std::vector<std::size_t> index;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (blocked[k] != 0) continue;
    free.push_back(segments[k]);
    index.push_back(k);
  }
  const auto meets_opening = clear_ ? clear_->occluded(free) : std::vector<std::uint8_t>(free.size(), 0);
  for (std::size_t k = 0; k < free.size(); ++k)
    found[index[k]] = meets_opening[k] != 0 ? through_openings(free[k]) : Passage{Spectrum::Ones(panes_.bands()), {}};
  return found;
}

// Goes from opening to opening, each of which a straight line meets once at most. The limit stops endless loops.
Passage LightPaths::through_openings(const Segment& segment) const {
  Passage passage{Spectrum::Ones(panes_.bands()), {}};
  const Vector way = segment.to - segment.from;
  const double length = way.norm();
  double gone = 0;
  Ray ray{segment.from, way / length, segment.from_polygon};
  for (int k = 0; k < 1 << 16; ++k) {
    const std::optional<Hit> hit = clear_->first_hits({&ray, 1}).front();
    if (!hit || gone + hit->distance >= length || hit->polygon == segment.to_polygon) break;
    gone += hit->distance;
    passage.transmittance *= panes_.transmittance(hit->polygon, ray.direction);
    passage.crossings.push_back({hit->polygon, gone});
    ray.origin = hit->point;
    ray.from_polygon = hit->polygon;
  }
  return passage;
}

std::vector<std::uint8_t> LightPaths::meets_opaque(std::span<const Segment> segments) const {
  return opaque_->occluded(segments);
}

std::vector<std::optional<Hit>> LightPaths::first_opaque_hits(std::span<const Ray> rays) const {
  return opaque_->first_hits(rays);
}

Point LightPaths::beyond(const Point& from, const Vector& direction) const {
  const double reach = bounds_.diagonal().norm() + (from - bounds_.center()).norm();
  return from + reach * direction;
}

bool LightPaths::may_be_hidden(std::span<const Point> receiver, const Vector& normal, const Point& centre,
                               double radius) const {
  std::array<Point, 8> around;
  for (std::size_t k = 0; k < around.size(); ++k)
    around[k] = centre + radius * Vector((k & 1U) != 0 ? 1 : -1, (k & 2U) != 0 ? 1 : -1, (k & 4U) != 0 ? 1 : -1);
  const HalfSpace behind{normal, normal.dot(receiver.front())};
  const auto reaches_between = [&](const Occluder& occluder) {
    const ShaftCuller& culler = occluder.shafts();
    return !culler.is_empty(culler.slabs(receiver), culler.slabs(around), behind, std::nullopt);
  };
  return reaches_between(*opaque_) || (clear_ && reaches_between(*clear_));
}

bool LightPaths::is_covered_in_part(PolygonIndex polygon, Side side) const {
  return opaque_->is_covered_in_part(polygon, side);
}

bool LightPaths::is_covered(PolygonIndex polygon, Side side, const Point& place) const {
  return opaque_->is_covered_in_part(polygon, side) && opaque_->is_covered(polygon, side, place);
}

}  // namespace patchlight
