#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"

#include <optional>
#include <vector>

namespace patchlight {

/// Texels around each chart that belong to it alone and repeat its light, so that what is interpolated at its edge has
/// nothing of another chart in it.
inline constexpr int lightmap_padding = 2;

/// The largest width and height of a lightmap, texels.
inline constexpr int most_lightmap_edge = 4096;

/// One chart for each group of coplanar faces, sides of polygons, of one material that share edges from corner to
/// corner; none for clear faces, which light goes through. Along its longest outer edge, without places yet. In the
/// order of the scene's polygons. O(n log n) for n corners.
std::vector<LightmapChart> charts_of(const Scene& scene, const PatchMesh& mesh);

/// The charts at their places in a map: in rows, the highest first, with padding around each. Width and height are
/// powers of two.
struct PackedCharts {
  std::vector<LightmapChart> charts;
  int width = 0;
  int height = 0;
  double texel = 0;  ///< metres
};

/// In the smallest square for texels of this size, or of the smallest size for which they fit into the largest map.
/// Without a size with the smallest texels for which they fit into 256 x 256 texels, or, where there are so many charts
/// that padding would take half of it, into the next larger square.
/// \throws InputError when they fit into no map.
PackedCharts packed_charts(const std::vector<LightmapChart>& charts, const std::optional<double>& texel);

/// The map with light at so many texels around each chart, and around its holes: beside a texel that is known as the
/// light goes on linearly from it and the one behind it, within 0 and twice what it is there, so that what is
/// interpolated at the edge of a chart is what there is; farther out the mean of what is beside.
Lightmap with_padding(Lightmap map, int texels);

}  // namespace patchlight
