#include "lighting/light_paths.h"

#include <algorithm>

namespace patchlight {

LightPaths::LightPaths(const Scene& scene, const Tracing& tracing)
    : bounds_(bounds(scene)),
      opaque_(tracing.opaque_faces()),
      clear_(tracing.clear_faces()),
      optics_(std::make_shared<const SurfaceOptics>(scene, tracing.reflections())) {}

Field LightPaths::transmittance(std::span<const Segment> segments) const {
  const auto blocked = opaque_->occluded(segments);
  const auto meets_opening = clear_ ? clear_->occluded(segments) : std::vector<std::uint8_t>(segments.size(), 0);
  Field share(static_cast<Eigen::Index>(segments.size()), optics_->bands());
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
    found[index[k]] = meets_opening[k] != 0 ? through_openings(free[k]) : Passage{Spectrum::Ones(optics_->bands()), {}};
  return found;
}

// Goes from opening to opening, each of which a straight line meets once at most. The limit stops endless loops.
Passage LightPaths::through_openings(const Segment& segment) const {
  Passage passage{Spectrum::Ones(optics_->bands()), {}};
  const Vector way = segment.to - segment.from;
  const double length = way.norm();
  double gone = 0;
  Ray ray{segment.from, way / length, segment.from_polygon};
  for (int k = 0; k < 1 << 16; ++k) {
    const std::optional<Hit> hit = clear_->first_hits({&ray, 1}).front();
    if (!hit || gone + hit->distance >= length || hit->polygon == segment.to_polygon) break;
    gone += hit->distance;
    passage.transmittance *= optics_->spectral_transmittance(hit->polygon, ray.direction);
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

bool LightPaths::hides(std::span<const Point> from, std::span<const Point> to) const {
  return opaque_->hides(from, to);
}

bool LightPaths::is_covered_in_part(PolygonIndex polygon, Side side) const {
  return opaque_->is_covered_in_part(polygon, side);
}

bool LightPaths::is_covered(PolygonIndex polygon, Side side, const Point& place) const {
  return opaque_->is_covered_in_part(polygon, side) && opaque_->is_covered(polygon, side, place);
}

}  // namespace patchlight
