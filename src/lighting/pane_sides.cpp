#include "lighting/pane_sides.h"

#include "scene/specular_faces.h"

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

// A front is met against its normal.
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

}  // namespace patchlight
