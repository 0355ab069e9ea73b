#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace patchlight {

/// A cube of a grid over all of space.
struct Cell {
  std::int64_t x = 0, y = 0, z = 0;
  bool operator==(const Cell&) const = default;
};

/// Patches that may be near, with their centroids.
struct NearPatches {
  std::vector<PatchIndex> patches;
  std::vector<Point> centroids;
};

/// The centroids of all patches in cubic cells, in a table with a slot for each hash of a cell. O(n log n) to build.
/// The same order for any number of threads.
class PatchCells {
 public:
  /// Cells with edges of `edge` metres.
  PatchCells(const PatchMesh& mesh, double edge);

  std::uint32_t slots() const { return mask_ + 1; }
  /// The patches of a slot stand at these places of the table, first and one after the last. Cells may share a slot;
  /// their patches follow each other.
  std::pair<std::uint32_t, std::uint32_t> places_in(std::uint32_t slot) const {
    return {first_[slot], first_[slot + 1]};
  }
  PatchIndex patch(std::uint32_t place) const { return patches_[place]; }
  const Cell& cell(std::uint32_t place) const { return cells_[place]; }

  /// All patches in a cell and in those around: none else is nearer than a cell's edge to what lies in it.
  NearPatches around(const Cell& home) const;

 private:
  Cell cell_of(const Point& point) const;
  std::uint32_t slot_of(const Cell& cell) const;

  double edge_;
  std::uint32_t mask_ = 0;
  std::vector<std::uint32_t> first_;  // per slot; one more at the end
  std::vector<PatchIndex> patches_;
  std::vector<Cell> cells_;       // of patches_
  std::vector<Point> centroids_;  // of patches_
};

}  // namespace patchlight
