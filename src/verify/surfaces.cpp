#include "verify/surfaces.h"

namespace patchlight {
namespace {

Surface surface_of(const Scene& scene, PolygonIndex index, Side side, const KeptSides& kept) {
  const Polygon& polygon = scene.polygons[index];
  const Material& material = scene.materials[material_on(polygon, side)];
  const bool is_front = side == Side::front;
  Surface surface;
  surface.kept = (is_front ? kept.front : kept.back)[index] != 0;
  surface.normal = is_front ? front_normal(scene, index) : Vector(-front_normal(scene, index));
  surface.reflectance = material.reflectance;
  surface.transmittance = material.transmittance.size() > 0 ? material.transmittance
                                                            : Spectrum(Spectrum::Zero(material.reflectance.size()));
  const bool emits = surface.kept && (is_front || polygon.back_material || kept.emit_from_back);
  surface.exitance = emits ? material.exitance : Spectrum(Spectrum::Zero(material.exitance.size()));
  return surface;
}

}  // namespace

Surfaces surfaces_of(const Scene& scene, const KeptSides& kept) {
  Surfaces surfaces;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) surfaces.sides.push_back(surface_of(scene, p, side, kept));
  }
  return surfaces;
}

Eigen::Matrix3d frame_around(const Vector& normal) {
  const Vector tangent = normal.unitOrthogonal();
  Eigen::Matrix3d frame;
  frame << tangent, normal.cross(tangent), normal;
  return frame;
}

}  // namespace patchlight
