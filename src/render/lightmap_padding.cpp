#include "render/lightmap_padding.h"

#include "patchlight/mesh/patch_mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

using Step = std::array<int, 2>;
constexpr std::array<Step, 4> straight_steps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
constexpr std::array<Step, 4> diagonal_steps = {{{1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

// Light that a texel goes on with: a row each of direct, indirect and radiance.
struct PaddingTexel {
  Eigen::Index texel = 0;
  std::array<TexelField, 3> light;
};

class Padding {
 public:
  explicit Padding(Lightmap map) : map_(std::move(map)) {
    for (const PatchIndex patch : map_.patch) known_.push_back(patch != no_patch);
  }

  void grow(bool linearly);
  Lightmap map() && { return std::move(map_); }

 private:
  std::optional<Eigen::Index> known(int x, int y) const;
  std::optional<PaddingTexel> light_at(int x, int y, const std::array<Step, 4>& steps, bool linearly) const;

  Lightmap map_;
  std::vector<std::uint8_t> known_;  // per texel
};

std::optional<Eigen::Index> Padding::known(int x, int y) const {
  if (x < 0 || y < 0 || x >= map_.width || y >= map_.height) return std::nullopt;
  const Eigen::Index texel = static_cast<Eigen::Index>(y) * map_.width + x;
  if (!known_[static_cast<std::size_t>(texel)]) return std::nullopt;
  return texel;
}

// The mean of what the texels in some directions say; nothing when none of them is known.
std::optional<PaddingTexel> Padding::light_at(int x, int y, const std::array<Step, 4>& steps, bool linearly) const {
  const std::array<const TexelField*, 3> fields = {&map_.direct, &map_.indirect, &map_.radiance};
  PaddingTexel found{static_cast<Eigen::Index>(y) * map_.width + x, {}};
  for (TexelField& light : found.light) light = TexelField::Zero(1, map_.direct.cols());
  float count = 0;
  for (const auto& [dx, dy] : steps) {
    const auto near = known(x + dx, y + dy);
    if (!near) continue;
    const auto far = linearly ? known(x + 2 * dx, y + 2 * dy) : std::nullopt;
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const auto here = fields[f]->row(*near);
      if (far)
        found.light[f] += (2 * here - fields[f]->row(*far)).max(0).min(2 * here);
      else
        found.light[f] += here;
    }
    ++count;
  }
  if (count == 0) return std::nullopt;
  for (TexelField& light : found.light) light /= count;
  return found;
}

void Padding::grow(bool linearly) {
  std::vector<PaddingTexel> ring;
  for (int y = 0; y < map_.height; ++y) {
    for (int x = 0; x < map_.width; ++x) {
      if (known(x, y)) continue;
      auto found = light_at(x, y, straight_steps, linearly);
      if (!found) found = light_at(x, y, diagonal_steps, linearly);
      if (found) ring.push_back(*std::move(found));
    }
  }
  for (const auto& [texel, light] : ring) {
    map_.direct.row(texel) = light[0];
    map_.indirect.row(texel) = light[1];
    map_.radiance.row(texel) = light[2];
    known_[static_cast<std::size_t>(texel)] = 1;
  }
}

}  // namespace

Lightmap with_padding(Lightmap map, int texels) {
  Padding padding(std::move(map));
  for (int ring = 0; ring < texels; ++ring) padding.grow(ring == 0);
  return std::move(padding).map();
}

}  // namespace patchlight
