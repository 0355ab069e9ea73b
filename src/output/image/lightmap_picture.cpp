#include "output/image/lightmap_picture.h"

#include "render/tone_map.h"

namespace patchlight {

DisplayImage picture_of_map(const Lightmap& map, const TexelField& radiance, double exposure, const Bands& bands) {
  DisplayImage image{map.width, map.height, {}};
  image.pixels.reserve(static_cast<std::size_t>(radiance.rows()));
  for (Eigen::Index row = 0; row < radiance.rows(); row += map.width) {
    const Field here = radiance.middleRows(row, map.width).cast<double>();
    const auto colours = tone_map(here, exposure, bands);
    image.pixels.insert(image.pixels.end(), colours.begin(), colours.end());
  }
  return image;
}

}  // namespace patchlight
