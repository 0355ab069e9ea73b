#include "lighting/mirror_chains.h"

#include "scene/transmittance.h"

#include <algorithm>
#include <cstddef>
#include <queue>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t most_mirrors = 16;
constexpr std::size_t most_chains = 1024;
constexpr double least_reflectance = 1e-3;

// What a material reflects at most in a band; of a clear one, of light from all directions alike.
double reflectance_of(const Material& material) {
  if (material.specular_reflectance.size() > 0) return material.specular_reflectance.maxCoeff();
  const std::vector<Pane> panes = panes_of(material);
  double most = 0;
  for (const Pane& pane : panes) {
    double reflected = 0;
    for (std::size_t k = 0; k < cosine_steps; ++k)
      reflected += irradiance_of_step(k) * specular_reflectance(pane, cosine_of_step(k));
    most = std::max(most, reflected);
  }
  return most;
}

std::vector<MirrorSide> mirror_sides(const Scene& scene) {
  std::vector<double> by_material;
  for (const Material& material : scene.materials) by_material.push_back(reflectance_of(material));
  std::vector<MirrorSide> sides;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    const bool is_clear = is_opening(scene, p);
    for (const Side side : {Side::front, Side::back}) {
      const double reflectance = by_material[material_on(polygon, side)];
      if (!(reflectance > 0) || !(is_clear || is_mirror(scene, p, side))) continue;
      const Vector front = front_normal(scene, p);
      sides.push_back(
          {p, side, side == Side::front ? front : Vector(-front), scene.vertices[polygon.corners[0]], reflectance});
    }
  }
  return sides;
}

bool has_corner_before(const Scene& scene, PolygonIndex polygon, const MirrorSide& mirror, double tolerance) {
  return std::any_of(
      scene.polygons[polygon].corners.begin(), scene.polygons[polygon].corners.end(),
      [&](std::uint32_t corner) { return mirror.normal.dot(scene.vertices[corner] - mirror.on_plane) > tolerance; });
}

// x - 2 n n . (x - p)
Eigen::Affine3d reflection_at(const MirrorSide& mirror) {
  Eigen::Affine3d reflection;
  reflection.linear() = Eigen::Matrix3d::Identity() - 2 * mirror.normal * mirror.normal.transpose();
  reflection.translation() = 2 * mirror.normal.dot(mirror.on_plane) * mirror.normal;
  return reflection;
}

MirrorChain lengthened(const MirrorChain& chain, const MirrorSide& by) {
  MirrorChain longer = chain;
  longer.mirrors.push_back(by);
  longer.reflectance *= by.reflectance;
  longer.image = reflection_at(by) * chain.image;
  return longer;
}

// Those that reflect most come first, of equal ones those that were found first.
struct QueuedChain {
  MirrorChain chain;
  std::size_t number = 0;

  bool operator<(const QueuedChain& other) const {
    if (chain.reflectance != other.chain.reflectance) return chain.reflectance < other.chain.reflectance;
    return number > other.number;
  }
};

class ChainQueue {
 public:
  ChainQueue(const Scene& scene, std::vector<MirrorSide> sides)
      : scene_(scene), sides_(std::move(sides)), tolerance_(1e-7 * bounds(scene).diagonal().norm()) {
    for (const MirrorSide& side : sides_)
      if (has_scene_before(side)) add(lengthened({}, side));
  }

  bool empty() const { return queue_.empty(); }

  MirrorChain next() {
    MirrorChain chain = queue_.top().chain;
    queue_.pop();
    return chain;
  }

  // The same with one mirror more.
  void add_longer(const MirrorChain& chain) {
    const MirrorSide& last = chain.mirrors.back();
    for (const MirrorSide& side : sides_) {
      if (chain.reflectance * side.reflectance < least_reflectance) continue;
      if (!has_corner_before(scene_, side.polygon, last, tolerance_)) continue;
      if (has_corner_before(scene_, last.polygon, side, tolerance_)) add(lengthened(chain, side));
    }
  }

 private:
  void add(MirrorChain chain) { queue_.push({std::move(chain), number_++}); }

  bool has_scene_before(const MirrorSide& side) const {
    return std::any_of(scene_.vertices.begin(), scene_.vertices.end(),
                       [&](const Point& vertex) { return side.normal.dot(vertex - side.on_plane) > tolerance_; });
  }

  const Scene& scene_;
  std::vector<MirrorSide> sides_;
  double tolerance_;
  std::priority_queue<QueuedChain> queue_;
  std::size_t number_ = 0;
};

}  // namespace

MirrorChains mirror_chains(const Scene& scene) {
  ChainQueue queued(scene, mirror_sides(scene));
  MirrorChains found;
  while (!queued.empty()) {
    MirrorChain chain = queued.next();
    if (found.chains.size() == most_chains) {
      found.is_cut = true;
      found.cut_off = chain.reflectance;
      break;
    }
    if (chain.mirrors.size() < most_mirrors) queued.add_longer(chain);
    found.chains.push_back(std::move(chain));
  }
  return found;
}

}  // namespace patchlight
