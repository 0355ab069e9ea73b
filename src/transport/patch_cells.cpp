#include "transport/patch_cells.h"

#include "base/parallel.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace patchlight {
namespace {

// Bits of a place along one axis: those of three axes fit into one number.
constexpr int bits = 20;

// Patches whose cells one task finds.
constexpr std::size_t found_at_once = 4096;

using Places = std::array<std::uint64_t, 3>;  // along x, y and z

// The lower bits of a number, each followed by two bits that are 0.
std::uint64_t spread(std::uint64_t number) {
  number = (number | number << 32) & 0x001f00000000ffff;
  number = (number | number << 16) & 0x001f0000ff0000ff;
  number = (number | number << 8) & 0x100f00f00f00f00f;
  number = (number | number << 4) & 0x10c30c30c30c30c3;
  return (number | number << 2) & 0x1249249249249249;
}

// And back.
std::uint64_t gathered(std::uint64_t number) {
  number &= 0x1249249249249249;
  number = (number | number >> 2) & 0x10c30c30c30c30c3;
  number = (number | number >> 4) & 0x100f00f00f00f00f;
  number = (number | number >> 8) & 0x001f0000ff0000ff;
  number = (number | number >> 16) & 0x001f00000000ffff;
  return (number | number >> 32) & 0x1fffff;
}

std::uint64_t code_of(const Places& places) {
  return spread(places[0]) << 2 | spread(places[1]) << 1 | spread(places[2]);
}

Places places_of(std::uint64_t code) { return {gathered(code >> 2), gathered(code >> 1), gathered(code)}; }

Box box_around(const std::vector<Point>& points) {
  Box box;
  for (const Point& point : points) box.extend(point);
  return box;
}

}  // namespace

PatchCells::PatchCells(const PatchMesh& mesh, double length) : centroids_(mesh.centroid), places_(mesh.size()) {
  assert(length > 0);
  if (places_.empty()) return;
  const Box box = box_around(mesh.centroid);
  // A little wider: patches as near as `length` lie in one cell or in neighbouring ones although their places are
  // rounded.
  constexpr double wider = 1 + 0x1p-30;
  const int halvings = bits - 2 - std::ilogb(std::max(1.0, box.sizes().maxCoeff() / length));
  edge_ = std::ldexp(wider * length, -halvings);
  parallel_for((mesh.size() + found_at_once - 1) / found_at_once, [&](std::size_t task) {
    const std::size_t end = std::min<std::size_t>(mesh.size(), (task + 1) * found_at_once);
    for (std::size_t i = task * found_at_once; i < end; ++i) {
      const Vector edges = (mesh.centroid[i] - box.min()) / edge_;
      const auto along = [&](int axis) { return static_cast<std::uint64_t>(edges[axis]); };
      places_[i] = {code_of({along(0), along(1), along(2)}), static_cast<PatchIndex>(i)};
    }
  });
  std::sort(places_.begin(), places_.end());
}

int PatchCells::level_of(double length) const {
  // length = share 2^exponent edges, with a share of 1/2 up to, but not, 1.
  int exponent = 0;
  const double share = std::frexp(length / edge_, &exponent);
  return std::clamp(share > 0.5 ? exponent : exponent - 1, 0, bits);
}

void PatchCells::add_patches_in(const Cell& cell, NearPatches& near) const {
  const int shift = 3 * cell.level;
  auto place = std::lower_bound(places_.begin(), places_.end(), Place{cell.code << shift, 0});
  for (; place != places_.end() && place->code >> shift == cell.code; ++place) {
    near.patches.push_back(place->patch);
    for (int axis = 0; axis < 3; ++axis)
      near.centroids[static_cast<std::size_t>(axis)].push_back(centroids_[place->patch][axis]);
  }
}

NearPatches PatchCells::around(const Cell& home) const {
  NearPatches near;
  const auto [x, y, z] = places_of(home.code);
  const std::uint64_t end = std::uint64_t{1} << (bits - home.level);  // along each axis
  for (std::uint64_t k = 0; k < 27; ++k) {
    // Below the first cell the number is past the last one.
    const Places places{x + k / 9 - 1, y + k / 3 % 3 - 1, z + k % 3 - 1};
    if (std::all_of(places.begin(), places.end(), [end](std::uint64_t place) { return place < end; }))
      add_patches_in({home.level, code_of(places)}, near);
  }
  return near;
}

}  // namespace patchlight
