#include "lighting/mirror_chains.h"

#include "scene/transmittance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <queue>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t most_mirrors = 16;
constexpr std::size_t most_chains = 1024;
constexpr double least_reflectance = 1e-3;
constexpr double least_share = 1e-3;

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

// Lamps of a scene with very many are looked at up to here.
constexpr std::size_t most_lamps = 256;

Point middle_of(const std::vector<Point>& corners) {
  Point middle = Point::Zero();
  for (const Point& corner : corners) middle += corner / static_cast<double>(corners.size());
  return middle;
}

std::vector<Point> places_of_lamps(const Scene& scene) {
  std::vector<Point> places;
  for (const Luminaire& luminaire : scene.luminaires) places.push_back(luminaire.position);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_lamp(scene, p)) places.push_back(middle_of(corner_points(scene, p)));
  }
  places.resize(std::min(places.size(), most_lamps));
  return places;
}

// Of the light of a lamp all around it: A cos / (4 pi d^2), one half at most.
double share_seen_from(const Point& lamp, const Point& middle, const Vector& normal, double area) {
  const Vector way = lamp - middle;
  const double before = normal.dot(way);
  if (!(before > 0)) return 0;
  return std::min(0.5, area * before / std::pow(way.norm(), 3) / (4 * std::numbers::pi));
}

std::vector<MirrorSide> with_light_shares(const Scene& scene, std::vector<MirrorSide> sides) {
  const std::vector<Point> lamps = places_of_lamps(scene);
  const auto area_of = [&](const MirrorSide& side) { return area_vector(corner_points(scene, side.polygon)).norm(); };
  double all = 0;
  for (const MirrorSide& side : sides) all += area_of(side);
  for (MirrorSide& side : sides) {
    const Point middle = middle_of(corner_points(scene, side.polygon));
    const double area = area_of(side);
    side.light_share = area / all;
    for (const Point& lamp : lamps)
      side.light_share = std::max(side.light_share, share_seen_from(lamp, middle, side.normal, area));
  }
  return sides;
}

// So far before a plane something has to be to count.
double tolerance_in(const Scene& scene) { return 1e-7 * bounds(scene).diagonal().norm(); }

bool has_scene_before(const Scene& scene, const MirrorSide& side, double tolerance) {
  return std::any_of(scene.vertices.begin(), scene.vertices.end(),
                     [&](const Point& vertex) { return side.normal.dot(vertex - side.on_plane) > tolerance; });
}

std::vector<MirrorSide> mirror_sides(const Scene& scene) {
  const double tolerance = tolerance_in(scene);
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
      const MirrorSide mirror{p, side, side == Side::front ? front : Vector(-front), scene.vertices[polygon.corners[0]],
                              reflectance};
      if (has_scene_before(scene, mirror, tolerance)) sides.push_back(mirror);
    }
  }
  return with_light_shares(scene, std::move(sides));
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
  longer.light_share = std::min(chain.light_share, by.light_share);
  longer.image = reflection_at(by) * chain.image;
  return longer;
}

// About so much light goes by it.
double light_by(const MirrorChain& chain) { return chain.reflectance * chain.light_share; }

// Those by which most light goes come first, of equal ones those that were found first.
struct QueuedChain {
  MirrorChain chain;
  std::size_t number = 0;

  bool operator<(const QueuedChain& other) const {
    if (light_by(chain) != light_by(other.chain)) return light_by(chain) < light_by(other.chain);
    return number > other.number;
  }
};

class ChainQueue {
 public:
  ChainQueue(const Scene& scene, std::vector<MirrorSide> sides)
      : scene_(scene), sides_(std::move(sides)), tolerance_(tolerance_in(scene)) {
    for (const MirrorSide& side : sides_) least_ = std::max(least_, least_share * light_by(lengthened({}, side)));
    for (const MirrorSide& side : sides_) add(lengthened({}, side));
  }

  bool empty() const { return queue_.empty(); }

  MirrorChain next() {
    MirrorChain chain = queue_.top().chain;
    queue_.pop();
    return chain;
  }

  // The same with one mirror more. Returns the highest reflectance of one with which it is too long to be followed.
  double add_longer(const MirrorChain& chain) {
    const MirrorSide& last = chain.mirrors.back();
    double too_long = 0;
    for (const MirrorSide& side : sides_) {
      if (!has_corner_before(scene_, side.polygon, last, tolerance_)) continue;
      if (!has_corner_before(scene_, last.polygon, side, tolerance_)) continue;
      const bool is_followed =
          chain.mirrors.size() < most_mirrors && chain.reflectance * side.reflectance >= least_reflectance;
      if (is_followed)
        add(lengthened(chain, side));
      else
        too_long = std::max(too_long, side.reflectance);
    }
    return too_long;
  }

 private:
  void add(MirrorChain chain) {
    if (light_by(chain) >= least_) queue_.push({std::move(chain), number_++});
  }

  const Scene& scene_;
  std::vector<MirrorSide> sides_;
  double tolerance_;
  std::priority_queue<QueuedChain> queue_;
  std::size_t number_ = 0;
  double least_ = 0;  // light by a chain that is followed
};

// The light by all longer chains, none of which is followed, over that by one of n mirrors, where each goes on over one
// mirror, as between two: each mirror more reflects rho, so that it is rho / (1 - rho) at most; and images come to lie
// farther off, as k = n + 1, n + 2 ... do between two mirrors, so that it is less than the sum of n^2 / k^2, which is
// less than n.
double light_beyond(const MirrorChain& chain, double reflectance) {
  const auto mirrors = static_cast<double>(chain.mirrors.size());
  return reflectance < 1 ? std::min(mirrors, reflectance / (1 - reflectance)) : mirrors;
}

}  // namespace

MirrorChains mirror_chains(const Scene& scene) {
  const std::vector<MirrorSide> sides = mirror_sides(scene);
  ChainQueue queued(scene, sides);
  MirrorChains found;
  while (!queued.empty() && found.chains.size() < most_chains) {
    MirrorChain chain = queued.next();
    chain.beyond = light_beyond(chain, queued.add_longer(chain));
    found.chains.push_back(std::move(chain));
  }
  found.is_cut = !queued.empty();
  double all = 0;
  for (const MirrorSide& side : sides) all += side.reflectance * side.light_share;
  double followed = 0;
  for (const MirrorChain& chain : found.chains) followed += chain.mirrors.size() == 1 ? light_by(chain) : 0;
  found.left_out = all > 0 ? std::max(0.0, 1 - followed / all) : 0;
  return found;
}

}  // namespace patchlight
