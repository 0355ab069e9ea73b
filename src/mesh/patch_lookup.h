#pragma once

#include "patchlight/base/large_array.h"
#include "patchlight/mesh/patch_mesh.h"

#include "mesh/noded_lines.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// Equal parallelograms, row by row, as most rectangles are cut into: the patch follows from the place.
struct PatchLattice {
  Point origin;
  Vector to_u, to_v;  ///< (x - origin) . to_u counts the patches along the first edge
  int count_u = 0, count_v = 0;

  /// The patch at a point, counted from the first one; outside of all the nearest.
  PatchIndex patch_at(const Point& point) const;
};

/// The lattice of two or more patches of one polygon side; nothing where they are none. O(patches).
std::optional<PatchLattice> lattice_of(const PatchMesh& mesh, PatchRange range);

/// A point on one side of a polygon.
struct SidePoint {
  PolygonIndex polygon;
  Side side;
  Point point;
};

/// Finds the patch at a point: per polygon side with several patches a uniform grid of cells in the polygon's plane,
/// each with the patches whose bounds overlap it. Most points lie in the patch at the middle of their cell, and need no
/// other.
class PatchLookup {
 public:
  /// Keeps a reference to the mesh, which must outlive it.
  explicit PatchLookup(const PatchMesh& mesh);

  /// The patch of this polygon side that contains the point or, for a point slightly outside of all by rounding, the
  /// nearest of the cell; nothing when the side is not kept.
  std::optional<PatchIndex> patch_at(PolygonIndex polygon, Side side, const Point& point) const;

  /// The same for many points, as no_patch where there is none: the time is that of reading memory, and here many
  /// reads are under way at once.
  std::vector<PatchIndex> patches_at(std::span<const SidePoint> points) const;

 private:
  // The corners of a patch in the plane, counter-clockwise, side by side in memory; a triangle repeats its last.
  struct alignas(64) Outline {
    std::array<double, 4> u, v;
  };
  // A cell and the patch at its middle, in one line of memory: the corners are in single precision from the first one
  // on, which is exact enough for all but points next to an edge.
  struct alignas(64) CellPatches {
    double u = 0, v = 0;  // of the first corner
    std::array<float, 3> to_u{}, to_v{};
    float size = 0;                    // the largest of these
    PatchIndex middle = no_patch;      // this patch; none where no patch is there
    std::uint32_t begin = 0, end = 0;  // all patches of the cell, in Grid::patches
  };
  struct Grid {
    std::optional<PatchLattice> lattice;  // then the rest is empty
    PatchIndex first = 0;
    int axis_u = 0, axis_v = 1;  // the two coordinates that the plane is projected on
    double lower_u = 0, lower_v = 0, cells_per_u = 0, cells_per_v = 0;
    int count_u = 0, count_v = 0;
    LargeArray<CellPatches> cells;
    LargeArray<PatchIndex> patches;
    LargeArray<Outline> outlines;  // of its patches, the first one first

    std::span<const PatchIndex> patches_of(const CellPatches& cell) const {
      return std::span(patches).subspan(cell.begin, cell.end - cell.begin);
    }
    const Outline& outline(PatchIndex patch) const { return outlines[patch - first]; }
  };
  Grid make_grid(PatchRange range) const;
  static CellPatches with_middle(CellPatches cell, const Grid& grid, const FlatPoint& middle);
  static bool surely_holds(const CellPatches& cell, const FlatPoint& point);
  static LargeArray<CellPatches> cells_of(const Grid& grid, std::span<const std::uint32_t> begin);
  Outline outline_of(const Grid& grid, PatchIndex patch) const;
  const Grid& grid_on(PolygonIndex polygon, Side side) const;
  // A point of several that is looked for in a cell of a grid.
  struct Searched {
    std::size_t place;  // of the point among these
    const Grid* grid;
    std::size_t cell;
  };
  static std::vector<PatchIndex> with_searched(std::vector<PatchIndex> patches, std::span<const Searched> searched,
                                               std::span<const SidePoint> points);
  static PatchIndex patch_in(const Grid& grid, const Point& point);

  const PatchMesh& mesh_;
  LargeArray<std::uint32_t> grid_of_;  // per 2 * polygon + side: its grid, where it has several patches
  std::vector<Grid> grids_;
};

}  // namespace patchlight
