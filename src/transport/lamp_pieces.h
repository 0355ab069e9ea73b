#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include "form_factor/pair_samples.h"
#include "form_factor/patch_shape.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

class Occluder;

/// A side of a polygon that shines evenly.
struct LampSide {
  PolygonIndex polygon = no_polygon;
  Side side = Side::front;
};

/// The triangles and convex quadrilaterals that a side consists of.
std::size_t piece_count(const Scene& scene, const LampSide& lamp);

/// One of them.
struct LampPiece {
  PatchShape shape;
  SampledPatch sampled;
  double held = 1;        ///< the share of the light that arrives there which it holds back
  std::uint32_t key = 0;  ///< chooses random points
  std::size_t lamp = 0;   ///< which of the lamps it belongs to
};

/// The pieces of all lamps, one lamp after the other. `keys` of the mesh's patches, patch_keys().
std::vector<LampPiece> lamp_pieces(const Scene& scene, const PatchMesh& mesh, const Occluder& occluder,
                                   std::span<const LampSide> lamps, const std::vector<std::uint32_t>& keys);

}  // namespace patchlight
