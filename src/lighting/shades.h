#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"

#include "lighting/receiver.h"
#include "optics/surface_optics.h"
#include "scene/coverings.h"
#include "scene/light_place.h"
#include "visibility/shaft.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A convex polygon of a plane, counter-clockwise.
using PlanarOutline = std::vector<Eigen::Vector2d>;

/// The area of an outline, m^2; negative when it runs clockwise.
double area_of(const PlanarOutline& outline);

/// The shadow of something on a region.
struct Shade {
  PlanarOutline outline;
  const Spectrum* transmittance = nullptr;  ///< of the polygon that throws it; lives elsewhere; null: opaque
};

/// Integral over a convex region of the product of the transmittances of all shades there, m^2 per band: exact up to
/// rounding. Shades may overlap and reach beyond the region. Regions in which many meet are halved first. Nothing when
/// that would take too long.
std::optional<Spectrum> lit_area(const PlanarOutline& region, const std::vector<Shade>& shades, Eigen::Index bands);

/// A part of a patch, convex.
struct LitPart {
  std::array<Point, 4> corners;
  double exposed = 0;  ///< area that no other polygon covers, m^2
  Spectrum lit;        ///< integral over it of the transmittance, m^2 per band
  Spectrum uneven;     ///< the lit or the unlit area, if it is less, that lies anywhere in the part; 0 where all of the
                       ///< part lies behind the same panes
  Spectrum doubt;      ///< its standard error, because the transmittance of panes varies over the part
};

/// The shadows of polygons between patches and a light without extent, by geometry alone: however small a hole is, the
/// light that gets through it is found. Immutable and safe to use from several threads.
class Shades {
 public:
  Shades(const Scene& scene, const Coverings& coverings, std::shared_ptr<const SurfaceOptics> optics);

  /// Mean transmittance per band, over the exposed part of a patch, of the ways from a light before it: exact up to
  /// rounding, but that panes count with the transmittance towards one place of the patch. Nothing where the shadows of
  /// too many polygons meet to find it in reasonable time.
  std::optional<Spectrum> transmittance(const Receiver& patch, const LightPlace& light) const;

  /// The same by parts, sixteen of a patch, with panes as from the middle and the corners of each.
  std::optional<std::vector<LitPart>> lit_parts(const Receiver& patch, const LightPlace& light) const;

 private:
  struct Triangle {
    std::array<Point, 3> corners;
    Vector normal;  // of the polygon's front
    PolygonIndex polygon = no_polygon;
  };
  struct Node {
    Box box;
    std::uint32_t next = 0;  // the node after those below this one
    std::uint32_t triangle = 0;
    bool is_leaf = false;
  };
  using Indices = std::vector<std::uint32_t>;
  struct Shadows;

  void add_nodes(std::span<std::uint32_t> triangles);
  Indices triangles_over(std::span<const HalfSpace> below) const;
  std::optional<Shadows> shadows_on(const Receiver& patch, const LightPlace& light) const;
  bool lies_under(PolygonIndex polygon, PolygonIndex other) const;
  std::optional<LitPart> lit_part(Shadows& shadows, const std::array<Point, 4>& corners, const LightPlace& light) const;

  double tolerance_ = 0;  // of heights, m
  Eigen::Index bands_ = 0;
  Coverings coverings_;
  std::shared_ptr<const SurfaceOptics> optics_;
  std::vector<Triangle> triangles_;          // polygon by polygon
  std::vector<std::size_t> first_triangle_;  // of each polygon; and the number of all
  std::vector<Node> nodes_;
};

}  // namespace patchlight
