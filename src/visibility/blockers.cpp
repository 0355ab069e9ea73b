#include "visibility/blockers.h"

#include "visibility/convex_hull.h"

namespace patchlight {
namespace {

std::vector<std::uint8_t> none_of(const Scene& scene) { return std::vector<std::uint8_t>(scene.polygons.size(), 0); }

}  // namespace

bool lets_through(Occluder::Blockers which) {
  return which != Occluder::Blockers::opaque && which != Occluder::Blockers::clear;
}

std::vector<std::uint8_t> without_kind(std::vector<std::uint8_t> left_out, const Scene& scene, bool clear) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    if (is_opening(scene, p) == clear) left_out[p] = 1;
  return left_out;
}

std::vector<std::uint8_t> left_out_by(Occluder::Blockers which, const Scene& scene) {
  if (which == Occluder::Blockers::all) return none_of(scene);
  if (which == Occluder::Blockers::none) return std::vector<std::uint8_t>(scene.polygons.size(), 1);
  if (which == Occluder::Blockers::inside_hull) return on_convex_hull(scene);
  std::vector<std::uint8_t> left_out;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    left_out.push_back(is_opening(scene, p) == (which == Occluder::Blockers::opaque));
  return left_out;
}

std::vector<std::uint8_t> never_met(Occluder::Blockers which, const Scene& scene) {
  return lets_through(which) ? none_of(scene) : left_out_by(which, scene);
}

}  // namespace patchlight
