#include "transport/patch_cells.h"

#include "base/parallel.h"
#include "base/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace patchlight {
namespace {

// Patches, or slots, that one task puts in order.
constexpr std::size_t found_at_once = 4096;

// So many patches to a slot in the mean: about as many as lie in a cell.
constexpr std::size_t patches_per_slot = 8;

}  // namespace

Cell PatchCells::cell_of(const Point& point) const {
  const auto at = [&](int axis) { return static_cast<std::int64_t>(std::floor(point[axis] / edge_)); };
  return {at(0), at(1), at(2)};
}

std::uint32_t PatchCells::slot_of(const Cell& cell) const {
  std::uint32_t state = 0;
  for (const std::int64_t c : {cell.x, cell.y, cell.z})
    state = hash(state ^ (static_cast<std::uint32_t>(c) * 0x9e3779b9U));
  return state & mask_;
}

PatchCells::PatchCells(const PatchMesh& mesh, double edge) : edge_(edge) {
  std::uint32_t slots = 1;
  while (slots * patches_per_slot < mesh.size()) slots *= 2;
  mask_ = slots - 1;

  // 1. By slots: sort by counting.
  std::vector<std::uint32_t> slot(mesh.size());
  parallel_for((mesh.size() + found_at_once - 1) / found_at_once, [&](std::size_t task) {
    const std::size_t end = std::min<std::size_t>(mesh.size(), (task + 1) * found_at_once);
    for (std::size_t i = task * found_at_once; i < end; ++i) slot[i] = slot_of(cell_of(mesh.centroid[i]));
  });
  first_.assign(std::size_t{slots} + 1, 0);
  for (const std::uint32_t s : slot) ++first_[std::size_t{s} + 1];
  for (std::size_t s = 0; s < slots; ++s) first_[s + 1] += first_[s];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  patches_.resize(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) patches_[next[slot[i]]++] = i;

  // 2. By cells within each slot.
  const auto key = [&](PatchIndex patch) {
    const Cell cell = cell_of(mesh.centroid[patch]);
    return std::tuple(cell.x, cell.y, cell.z, patch);
  };
  parallel_for((slots + found_at_once - 1) / found_at_once, [&](std::size_t task) {
    const std::size_t end = std::min<std::size_t>(slots, (task + 1) * found_at_once);
    for (std::size_t s = task * found_at_once; s < end; ++s)
      std::sort(patches_.begin() + first_[s], patches_.begin() + first_[s + 1],
                [&](PatchIndex a, PatchIndex b) { return key(a) < key(b); });
  });
  cells_.reserve(mesh.size());
  centroids_.reserve(mesh.size());
  for (const PatchIndex i : patches_) {
    cells_.push_back(cell_of(mesh.centroid[i]));
    centroids_.push_back(mesh.centroid[i]);
  }
}

NearPatches PatchCells::around(const Cell& home) const {
  NearPatches near;
  for (int k = 0; k < 27; ++k) {
    const Cell cell{home.x + k / 9 - 1, home.y + k / 3 % 3 - 1, home.z + k % 3 - 1};
    const std::uint32_t s = slot_of(cell);
    for (std::uint32_t p = first_[s]; p < first_[s + 1]; ++p) {
      if (cells_[p] != cell) continue;
      near.patches.push_back(patches_[p]);
      near.centroids.push_back(centroids_[p]);
    }
  }
  return near;
}

}  // namespace patchlight
