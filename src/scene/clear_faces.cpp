#include "scene/clear_faces.h"

#include "base/sampling.h"
#include "scene/transmittance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

constexpr std::uint32_t opaque = ~0U;

}  // namespace

ClearFace::ClearFace(const Scene& scene, PolygonIndex polygon) {
  const Bands bands = bands_of(scene);
  for (const Side side : {Side::front, Side::back}) {
    const std::vector<Pane> panes = panes_of(scene.materials[material_on(scene.polygons[polygon], side)]);
    for (std::size_t band = 0; band < panes.size(); ++band) {
      const auto found = std::find_if(parts_.begin(), parts_.end(), [&](const Part& part) {
        return part.pane.index == panes[band].index && part.pane.internal == panes[band].internal;
      });
      const double weight = bands[band].luminous_weight / 2;
      if (found == parts_.end()) {
        parts_.push_back({weight, panes[band]});
      } else {
        found->weight += weight;
      }
    }
  }
  held_upto_.push_back(0);
  for (std::size_t k = 0; k < cosine_steps; ++k)
    held_upto_.push_back(held_upto_.back() + irradiance_of_step(k) * held_of(transmittance(cosine_of_step(k))));
  held_ = held_upto_.back();
  for (double& upto : held_upto_) upto /= held_;
}

double ClearFace::transmittance(double cosine) const {
  double sum = 0;
  for (const Part& part : parts_) sum += part.weight * patchlight::transmittance(part.pane, cosine);
  return sum;
}

double ClearFace::relative_held(double cosine) const { return held_of(transmittance(cosine)) / held_; }

// Within a step the density is taken as even.
double ClearFace::held_cosine(double u) const {
  const auto next = std::upper_bound(held_upto_.begin() + 1, held_upto_.end() - 1, u);
  const double before = *(next - 1);
  const auto step = static_cast<double>(next - held_upto_.begin() - 1);
  return std::clamp((step + (u - before) / (*next - before)) / cosine_steps, 0.0, 1.0);
}

ClearFaces::ClearFaces(const Scene& scene) {
  std::map<std::pair<MaterialIndex, MaterialIndex>, std::uint32_t> known;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_opening(scene, p)) continue;
    if (faces_.empty()) {
      of_polygon_.assign(scene.polygons.size(), opaque);
      normals_.assign(scene.polygons.size(), Vector::Zero());
    }
    const Polygon& polygon = scene.polygons[p];
    const auto [place, is_new] = known.insert({{material_on(polygon, Side::front), material_on(polygon, Side::back)},
                                               static_cast<std::uint32_t>(faces_.size())});
    if (is_new) faces_.emplace_back(scene, p);
    of_polygon_[p] = place->second;
    normals_[p] = front_normal(scene, p);
  }
}

const ClearFace* ClearFaces::at(PolygonIndex polygon) const {
  if (polygon >= of_polygon_.size() || of_polygon_[polygon] == opaque) return nullptr;
  return &faces_[of_polygon_[polygon]];
}

double ClearFaces::transmittance(PolygonIndex polygon, const Vector& direction) const {
  const ClearFace* const face = at(polygon);
  return face ? face->transmittance(cosine_between(normals_[polygon], direction)) : 0;
}

double ClearFaces::held(PolygonIndex polygon) const {
  const ClearFace* const face = at(polygon);
  return face ? face->held() : 1;
}

double ClearFaces::relative_held(PolygonIndex polygon, const Vector& direction) const {
  const ClearFace* const face = at(polygon);
  return face ? face->relative_held(cosine_between(normals_[polygon], direction)) : 1;
}

Vector ClearFaces::held_direction(PolygonIndex polygon, double u, double v) const {
  const ClearFace* const face = at(polygon);
  if (!face) return square_to_cosine_hemisphere(u, v);
  const double cosine = face->held_cosine(u);
  const double sine = std::sqrt(1 - cosine * cosine);
  const double angle = 2 * std::numbers::pi * v;
  return {sine * std::cos(angle), sine * std::sin(angle), cosine};
}

}  // namespace patchlight
