#include "lighting/mirror_chains.h"

#include "scene/transmittance.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t most_mirrors = 16;
constexpr std::size_t most_chains = 512;
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

// The chains with one mirror more.
std::vector<MirrorChain> longer_chains(const Scene& scene, std::span<const MirrorChain> chains,
                                       const std::vector<MirrorSide>& sides) {
  const double tolerance = 1e-7 * bounds(scene).diagonal().norm();
  std::vector<MirrorChain> longer;
  for (const MirrorChain& chain : chains) {
    const MirrorSide& last = chain.mirrors.back();
    for (const MirrorSide& next : sides) {
      if (chain.reflectance * next.reflectance < least_reflectance) continue;
      if (!has_corner_before(scene, next.polygon, last, tolerance)) continue;
      if (has_corner_before(scene, last.polygon, next, tolerance)) longer.push_back(lengthened(chain, next));
    }
  }
  return longer;
}

}  // namespace

MirrorChains mirror_chains(const Scene& scene) {
  const std::vector<MirrorSide> sides = mirror_sides(scene);
  std::vector<MirrorChain> longest;
  for (const MirrorSide& side : sides) longest.push_back(lengthened({}, side));
  MirrorChains found;
  for (std::size_t mirrors = 1; !longest.empty() && found.cut_off == 0; ++mirrors) {
    std::stable_sort(longest.begin(), longest.end(),
                     [](const MirrorChain& a, const MirrorChain& b) { return a.reflectance > b.reflectance; });
    const std::size_t room = mirrors > most_mirrors ? 0 : most_chains - found.chains.size();
    if (longest.size() > room) {
      found.cut_off = longest[room].reflectance;
      longest.resize(room);
    }
    found.chains.insert(found.chains.end(), longest.begin(), longest.end());
    if (found.cut_off == 0) longest = longer_chains(scene, longest, sides);
  }
  return found;
}

}  // namespace patchlight
