#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"

#include "render/gathered_light.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace patchlight {

/// Texels around each chart that belong to it alone and repeat its light: interpolation at its edge then takes nothing
/// of another chart.
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
  double texel = 0;  ///< meters
};

/// Packs charts into the smallest square for texels of this size, or of the smallest size for which they fit into the
/// largest map. Without a size, takes the smallest texels for which they fit into 256 x 256 texels. With so many charts
/// that padding would take half of that, it takes the next larger square. \throws InputError if they fit into no map.
PackedCharts packed_charts(const std::vector<LightmapChart>& charts, const std::optional<double>& texel);

/// The map with light at this many texels around each chart, and around its holes. Beside a known texel, light is
/// extrapolated linearly, within 0 and twice its light, so that interpolation at the edge of a chart is correct.
/// Farther out it is the mean of the adjacent texels.
Lightmap with_padding(Lightmap map, int texels);

/// Settings for the light at texels.
struct BakeOptions {
  int rays_to_lights = 4;                        ///< from each of sixteen places of a texel
  int gathers = 4;                               ///< so many of these places at which other light is gathered
  HemisphereOptions hemisphere = {.rays = 256};  ///< of each gather
  std::uint32_t seed = 1;
};

/// Bakes the light at the texels of charts: direct light by shadow rays, and reflected light by a final gather into the
/// solution, as in pictures. `sent_besides` is the light of each patch that does not depend on the irradiance on its
/// front: its exitance and the light through a sheet, W/m^2. The result does not depend on the number of threads.
/// \throws Canceled.
Lightmap bake(const SolvedLight& solved, const FieldView& sent_besides, PackedCharts charts, const BakeOptions& options,
              const Observer& observer = {});

}  // namespace patchlight
