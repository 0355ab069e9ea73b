#include "lighting/pane_sides.h"

#include "scene/transmittance.h"

namespace patchlight {

PaneSides::PaneSides(const Scene& scene) : bands_(number_of_bands(scene)) {
  for (const Material& material : scene.materials) panes_.push_back(panes_of(material));
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_opening(scene, p)) continue;
    if (sides_.empty()) sides_.resize(scene.polygons.size());
    const Polygon& polygon = scene.polygons[p];
    sides_[p] = {front_normal(scene, p), {material_on(polygon, Side::front), material_on(polygon, Side::back)}, true};
  }
}

Spectrum PaneSides::transmittance(PolygonIndex polygon, const Vector& direction) const {
  const Sides& sides = sides_[polygon];
  const double cosine = sides.normal.dot(direction);
  const std::vector<Pane>& panes = panes_[sides.materials[cosine < 0 ? 0 : 1]];
  if (panes.empty()) return Spectrum::Zero(bands_);
  return patchlight::transmittance(panes, cosine_between(sides.normal, direction));
}

}  // namespace patchlight
