#pragma once

#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"

#include "lighting/pane_sides.h"
#include "lighting/receiver.h"
#include "scene/coverings.h"
#include "scene/light_place.h"
#include "visibility/shaft.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A part of a patch, convex.
struct LitPart {
  std::array<Point, 4> corners;
  double exposed = 0;  ///< area that no other polygon covers, m^2
  Spectrum lit;        ///< integral over it of what is let through, m^2 per band
  Spectrum uneven;  ///< of that, or of the rest if it is less, what lies anywhere in the part; 0 where all of the part
                    ///< lies behind the same panes
  Spectrum doubt;   ///< its standard error, as panes let more through at one place of the part than at another
};

/// What stands between patches and a light that has no extent, by geometry alone: however small a hole is, the light
/// that gets through it is found. Immutable and safe to use from several threads.
class Shades {
 public:
  explicit Shades(const Scene& scene, const Coverings& coverings = {});

  /// Mean over the exposed part of a patch of what is let through from a light before it, per band: exact up to
  /// rounding, but that panes between it and a point let through what they do at one place of the patch. Nothing where
  /// the shadows of too many polygons meet to say so in reasonable time.
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
  PaneSides panes_;
  std::vector<Triangle> triangles_;          // polygon by polygon
  std::vector<std::size_t> first_triangle_;  // of each polygon; and the number of all
  std::vector<Node> nodes_;
};

}  // namespace patchlight
