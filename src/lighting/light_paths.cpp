#include "lighting/light_paths.h"

#include <array>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

// The rest of the segments from the last opening that they crossed.
struct RaysToCross {
  std::vector<Ray> rays;
  std::vector<std::size_t> segment;
  std::vector<double> gone;  // m, before the origin of the ray

  void add(const Ray& ray, std::size_t of, double way) {
    rays.push_back(ray);
    segment.push_back(of);
    gone.push_back(way);
  }
};

}  // namespace

LightPaths::LightPaths(const Scene& scene, const Tracing& tracing)
    : bounds_(bounds(scene)),
      opaque_(tracing.opaque_faces()),
      clear_(tracing.clear_faces()),
      optics_(std::make_shared<const SurfaceOptics>(scene, tracing.reflections())) {}

Field LightPaths::transmittance(std::span<const Segment> segments) const {
  const std::vector<Passage> found = passages(segments);
  Field share = Field::Zero(static_cast<Eigen::Index>(segments.size()), optics_->bands());
  for (std::size_t k = 0; k < segments.size(); ++k)
    if (found[k].transmittance.size() > 0) share.row(static_cast<Eigen::Index>(k)) = found[k].transmittance;
  return share;
}

std::vector<Passage> LightPaths::passages(std::span<const Segment> segments) const {
  const auto blocked = opaque_->occluded(segments);
  std::vector<Passage> found(segments.size());
  RaysToCross rays;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (blocked[k] != 0) continue;
    found[k].transmittance = Spectrum::Ones(optics_->bands());
    if (clear_)
      rays.add({segments[k].from, (segments[k].to - segments[k].from).normalized(), segments[k].from_polygon}, k, 0);
  }
  // A straight line meets each opening once at most. The limit stops endless loops.
  for (int step = 0; step < 1 << 16 && !rays.rays.empty(); ++step) {
    RaysToCross further;
    const auto hits = clear_->first_hits(rays.rays);
    for (std::size_t k = 0; k < hits.size(); ++k) {
      const std::optional<Hit>& hit = hits[k];
      const std::size_t of = rays.segment[k];
      const double gone = hit ? rays.gone[k] + hit->distance : 0;
      if (!hit || gone >= (segments[of].to - segments[of].from).norm() || hit->polygon == segments[of].to_polygon)
        continue;
      const Vector& direction = rays.rays[k].direction;
      found[of].transmittance *= optics_->spectral_transmittance(hit->polygon, direction);
      found[of].crossings.push_back({hit->polygon, gone});
      further.add({hit->point, direction, hit->polygon}, of, gone);
    }
    rays = std::move(further);
  }
  return found;
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
