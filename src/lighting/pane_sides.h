#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"

#include "light/pane.h"

#include <array>
#include <vector>

namespace patchlight {

/// What the clear polygons of a scene let straight through, and what these and mirrors reflect without scattering it,
/// per band: by the material of the side that is met.
class PaneSides {
 public:
  explicit PaneSides(const Scene& scene);

  Eigen::Index bands() const { return bands_; }

  /// False when no light goes through a polygon from either side.
  bool is_clear(PolygonIndex polygon) const { return !sides_.empty() && sides_[polygon].is_clear; }

  /// The share that a clear polygon lets through of the light that one sees in a unit direction.
  Spectrum transmittance(PolygonIndex polygon, const Vector& direction) const;

  /// False when a polygon reflects no light as a mirror does.
  bool is_specular(PolygonIndex polygon) const { return !sides_.empty() && sides_[polygon].is_specular; }

  /// The share that is_specular() ones reflect so of the light that one sees in a unit direction, which meets the side.
  Spectrum specular_reflectance(PolygonIndex polygon, const Vector& direction) const;

 private:
  struct Sides {
    Vector normal = Vector::Zero();  // of the front
    std::array<MaterialIndex, 2> materials{};
    bool is_clear = false;
    bool is_specular = false;
  };
  MaterialIndex material_met(const Sides& sides, const Vector& direction) const;

  Eigen::Index bands_;
  std::vector<std::vector<Pane>> panes_;  // per material and band; none of an opaque one
  std::vector<Spectrum> mirrors_;         // per material: its specular reflectance; empty: none
  std::vector<Sides> sides_;              // per polygon; none where none is clear or a mirror
};

}  // namespace patchlight
