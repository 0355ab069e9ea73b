#include "verify/path_scene.h"

#include "scene/coverings.h"

#include <optional>

namespace patchlight {

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

}  // namespace patchlight
