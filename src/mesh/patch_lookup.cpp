#include "mesh/patch_lookup.h"

#include "base/tolerances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

// Do the corners of a parallelogram lie at -1/2 and 1/2 along both directions, counted from its centroid?
bool is_cell(const PatchMesh& mesh, PatchIndex patch, const Vector& to_u, const Vector& to_v) {
  const PatchCorners corners = mesh.corner_points(patch);
  return corners.count == 4 && std::all_of(corners.points.begin(), corners.points.end(), [&](const Point& corner) {
           const Vector from = corner - mesh.centroid[patch];
           return std::abs(std::abs(from.dot(to_u)) - 0.5) <= tolerance_of_coordinates &&
                  std::abs(std::abs(from.dot(to_v)) - 0.5) <= tolerance_of_coordinates;
         });
}

// Points this share of the polygon side's extent outside of a patch still find it.
constexpr double lookup_slack = 4e-6;

FlatPoint flat(const auto& grid, const Point& point) { return {point[grid.axis_u], point[grid.axis_v]}; }

FlatLine edge(const auto& outline, std::size_t k) {
  const std::size_t next = (k + 1) % 4;
  return {FlatPoint(outline.u[k], outline.v[k]), FlatPoint(outline.u[next], outline.v[next])};
}

// Does a point lie beyond an edge of a counter-clockwise outline? An edge without length bounds nothing.
bool is_beyond(const FlatLine& edge, const FlatPoint& point) { return wedge(edge[1] - edge[0], point - edge[0]) < 0; }

// The patch is convex and counter-clockwise in the flat coordinates.
bool holds(const auto& outline, const FlatPoint& eye) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (is_beyond(edge(outline, k), eye)) return false;
  }
  return true;
}

// From outside: to the nearest of the edges beyond which the point lies. Zero inside.
double distance_to(const auto& outline, const FlatPoint& eye) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k) {
    if (is_beyond(edge(outline, k), eye)) nearest = std::min(nearest, to_line(eye, edge(outline, k)).norm());
  }
  return std::isfinite(nearest) ? nearest : 0;
}

struct Cell {
  int u, v;
};

// The cell at a point; the closest one for a point outside.
Cell cell_at(const auto& grid, const Point& point) {
  const FlatPoint at = flat(grid, point);
  const double u = (at.x() - grid.lower_u) * grid.cells_per_u;
  const double v = (at.y() - grid.lower_v) * grid.cells_per_v;
  return {static_cast<int>(std::clamp(u, 0.0, grid.count_u - 1.0)),
          static_cast<int>(std::clamp(v, 0.0, grid.count_v - 1.0))};
}

std::size_t cell_index(const auto& grid, Cell cell) {
  return static_cast<std::size_t>(cell.v) * static_cast<std::size_t>(grid.count_u) + static_cast<std::size_t>(cell.u);
}

Box box_of(const PatchMesh& mesh, PatchIndex patch) {
  Box box;
  for (const std::uint32_t vertex : mesh.corners[patch]) box.extend(mesh.vertices[vertex]);
  return box;
}

// The grid with its axes and cells, still without patches.
template <typename Grid>
Grid lay_out(const PatchMesh& mesh, PatchRange range, const Box& bounds) {
  Grid grid;
  grid.first = range.begin;

  // Leave out the coordinate in which the normal is longest; order the others so that patches stay counter-clockwise.
  const Vector& normal = mesh.normal[range.begin];
  Eigen::Index longest = 0;
  normal.cwiseAbs().maxCoeff(&longest);
  grid.axis_u = static_cast<int>((longest + 1) % 3);
  grid.axis_v = static_cast<int>((longest + 2) % 3);
  if (normal[longest] < 0) std::swap(grid.axis_u, grid.axis_v);

  // About as many cells as patches, about square.
  const double pad = lookup_slack * bounds.diagonal().norm();
  const double count = range.end - range.begin;
  const double size_u = bounds.sizes()[grid.axis_u] + 2 * pad;
  const double size_v = bounds.sizes()[grid.axis_v] + 2 * pad;
  const double cell = std::sqrt(size_u * size_v / count);
  grid.count_u = static_cast<int>(std::clamp(std::ceil(size_u / cell), 1.0, count));
  grid.count_v = static_cast<int>(std::clamp(std::ceil(size_v / cell), 1.0, count));
  grid.lower_u = bounds.min()[grid.axis_u] - pad;
  grid.lower_v = bounds.min()[grid.axis_v] - pad;
  grid.cells_per_u = grid.count_u / size_u;
  grid.cells_per_v = grid.count_v / size_v;
  return grid;
}

}  // namespace

std::optional<PatchLattice> lattice_of(const PatchMesh& mesh, PatchRange range) {
  // 1. The first row, as long as centroids are evenly spaced; then the step from row to row.
  const PatchIndex count = range.end - range.begin;
  const Point& first = mesh.centroid[range.begin];
  const Vector u = mesh.centroid[range.begin + 1] - first;
  const auto is_at = [&](PatchIndex k, const Point& place) {
    return (mesh.centroid[range.begin + k] - place).norm() <= tolerance_of_coordinates * u.norm();
  };
  PatchIndex row = 1;
  while (row < count && is_at(row, first + row * u)) ++row;
  if (count % row != 0) return std::nullopt;
  const PatchCorners corners = mesh.corner_points(range.begin);
  const Vector edge = corners.points[1] - corners.points[0];
  const Vector other = corners.points[3] - corners.points[0];
  const Vector v = row < count                                    ? Vector(mesh.centroid[range.begin + row] - first)
                   : edge.cross(u).norm() > other.cross(u).norm() ? edge
                                                                  : other;

  // 2. All of them are parallelograms in their places. The dual vectors: u . to_u = 1, v . to_u = 0.
  const Vector normal = u.cross(v);
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) return std::nullopt;
  const Vector to_u = v.cross(normal) / squared;
  const Vector to_v = normal.cross(u) / squared;
  for (PatchIndex k = 0; k < count; ++k) {
    if (!is_at(k, first + k % row * u + k / row * v) || !is_cell(mesh, range.begin + k, to_u, to_v))
      return std::nullopt;
  }
  return PatchLattice{first - 0.5 * u - 0.5 * v, to_u, to_v, static_cast<int>(row), static_cast<int>(count / row)};
}

PatchIndex PatchLattice::patch_at(const Point& point) const {
  const Vector to = point - origin;
  const auto place = [](double at, int count) { return static_cast<int>(std::clamp(at, 0.0, count - 0.5)); };
  const int column = place(to.dot(to_u), count_u);
  const int row = place(to.dot(to_v), count_v);
  return static_cast<PatchIndex>(row * count_u + column);
}

PatchLookup::PatchLookup(const PatchMesh& mesh) : mesh_(mesh) {
  for (std::size_t slot = 0; slot + 1 < mesh.first_patch.size(); ++slot) {
    grid_of_.push_back(static_cast<std::uint32_t>(grids_.size()));
    const PatchRange range{mesh.first_patch[slot], mesh.first_patch[slot + 1]};
    if (range.end - range.begin > 1) grids_.push_back(make_grid(range));
  }
}

PatchLookup::Outline PatchLookup::outline_of(const Grid& grid, PatchIndex patch) const {
  const PatchCorners corners = mesh_.corner_points(patch);
  Outline outline{};
  for (std::size_t k = 0; k < 4; ++k) {
    const FlatPoint at = flat(grid, corners.points[k]);
    outline.u[k] = at.x();
    outline.v[k] = at.y();
  }
  return outline;
}

PatchLookup::CellPatches PatchLookup::with_middle(CellPatches cell, const Grid& grid, const FlatPoint& middle) {
  for (const PatchIndex patch : grid.patches_of(cell)) {
    const Outline& outline = grid.outline(patch);
    if (!holds(outline, middle)) continue;
    cell.middle = patch;
    cell.u = outline.u[0], cell.v = outline.v[0];
    for (std::size_t k = 0; k < 3; ++k) {
      cell.to_u[k] = static_cast<float>(outline.u[k + 1] - cell.u);
      cell.to_v[k] = static_cast<float>(outline.v[k + 1] - cell.v);
      cell.size = std::max({cell.size, std::abs(cell.to_u[k]), std::abs(cell.to_v[k])});
    }
    break;
  }
  return cell;
}

LargeArray<PatchLookup::CellPatches> PatchLookup::cells_of(const Grid& grid, std::span<const std::uint32_t> begin) {
  LargeArray<CellPatches> cells;
  cells.reserve(begin.size() - 1);
  for (int v = 0; v < grid.count_v; ++v) {
    for (int u = 0; u < grid.count_u; ++u) {
      const CellPatches cell{.begin = begin[cells.size()], .end = begin[cells.size() + 1]};
      const FlatPoint middle(grid.lower_u + (u + 0.5) / grid.cells_per_u, grid.lower_v + (v + 0.5) / grid.cells_per_v);
      cells.push_back(with_middle(cell, grid, middle));
    }
  }
  return cells;
}

PatchLookup::Grid PatchLookup::make_grid(PatchRange range) const {
  if (auto lattice = lattice_of(mesh_, range)) {
    Grid grid;
    grid.lattice = *lattice;
    return grid;
  }
  Box bounds;
  for (PatchIndex patch = range.begin; patch < range.end; ++patch) bounds.extend(box_of(mesh_, patch));
  Grid grid = lay_out<Grid>(mesh_, range, bounds);
  grid.outlines.reserve(range.end - range.begin);
  for (PatchIndex patch = range.begin; patch < range.end; ++patch) grid.outlines.push_back(outline_of(grid, patch));

  // Sort the patches into the cells that their padded bounds overlap: count, then fill from the back.
  const Point pad = Point::Constant(lookup_slack * bounds.diagonal().norm());
  std::vector<std::uint32_t> begin(static_cast<std::size_t>(grid.count_u) * static_cast<std::size_t>(grid.count_v) + 1,
                                   0);
  const auto for_cells_of = [&](PatchIndex patch, const auto& visit) {
    const Box box = box_of(mesh_, patch);
    const Cell low = cell_at(grid, box.min() - pad);
    const Cell high = cell_at(grid, box.max() + pad);
    for (int v = low.v; v <= high.v; ++v) {
      for (int u = low.u; u <= high.u; ++u) visit(begin[cell_index(grid, {u, v})]);
    }
  };
  for (PatchIndex patch = range.begin; patch < range.end; ++patch) {
    for_cells_of(patch, [](std::uint32_t& entry) { ++entry; });
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  grid.patches.resize(begin.back());
  for (PatchIndex patch = range.end; patch-- > range.begin;) {
    for_cells_of(patch, [&](std::uint32_t& entry) { grid.patches[--entry] = patch; });
  }
  grid.cells = cells_of(grid, begin);
  return grid;
}

// Is a point inside of the patch at the middle of its cell by more than the corners are rounded, each by 6e-8 of
// `size`? A cross product is off by less than 4e-7 size (size + |x| + |y|) then.
bool PatchLookup::surely_holds(const CellPatches& cell, const FlatPoint& point) {
  if (!(cell.size > 0)) return false;
  const FlatPoint eye(point.x() - cell.u, point.y() - cell.v);
  const double size = cell.size;
  const double least = 4e-7 * size * (size + eye.lpNorm<1>());
  FlatPoint from(0, 0);
  for (std::size_t k = 0; k < 4; ++k) {
    const FlatPoint to = k < 3 ? FlatPoint(cell.to_u[k], cell.to_v[k]) : FlatPoint(0, 0);
    if (to != from && !(wedge(to - from, eye - from) > least)) return false;
    from = to;
  }
  return true;
}

PatchIndex PatchLookup::patch_in(const Grid& grid, const Point& point) {
  // 1. The first patch of the point's cell that holds it.
  const FlatPoint eye = flat(grid, point);
  const Cell home = cell_at(grid, point);
  const CellPatches& at_home = grid.cells[cell_index(grid, home)];
  if (surely_holds(at_home, eye)) return at_home.middle;
  for (const PatchIndex patch : grid.patches_of(at_home))
    if (holds(grid.outline(patch), eye)) return patch;

  // 2. Else the nearest of it or, when it is empty, of the closest ring of cells around it that is not.
  PatchIndex nearest = no_patch;
  double shortest = std::numeric_limits<double>::infinity();
  const auto search_cell = [&](Cell cell) {
    if (cell.u < 0 || cell.u >= grid.count_u || cell.v < 0 || cell.v >= grid.count_v) return;
    for (const PatchIndex patch : grid.patches_of(grid.cells[cell_index(grid, cell)])) {
      const double distance = distance_to(grid.outline(patch), eye);
      if (distance < shortest) shortest = distance, nearest = patch;
    }
  };
  search_cell(home);
  for (int ring = 1; nearest == no_patch; ++ring) {
    for (int k = -ring; k < ring; ++k) {
      search_cell({home.u + k, home.v - ring});
      search_cell({home.u + ring, home.v + k});
      search_cell({home.u - k, home.v + ring});
      search_cell({home.u - ring, home.v - k});
    }
  }
  return nearest;
}

const PatchLookup::Grid& PatchLookup::grid_on(PolygonIndex polygon, Side side) const {
  return grids_[grid_of_[side_slot(polygon, side)]];
}

std::optional<PatchIndex> PatchLookup::patch_at(PolygonIndex polygon, Side side, const Point& point) const {
  const PatchRange range = mesh_.patches_on(polygon, side);
  if (range.begin == range.end) return std::nullopt;
  if (range.end - range.begin == 1) return range.begin;
  const Grid& grid = grid_on(polygon, side);
  return grid.lattice ? range.begin + grid.lattice->patch_at(point) : patch_in(grid, point);
}

// Fills in the patches that are searched for. Memory is requested before it is needed.
std::vector<PatchIndex> PatchLookup::with_searched(std::vector<PatchIndex> patches, std::span<const Searched> searched,
                                                   std::span<const SidePoint> points) {
  // 1. Those at the middles of their cells.
  std::vector<Searched> rest;
  for (const Searched& each : searched) {
    const CellPatches& cell = each.grid->cells[each.cell];
    if (surely_holds(cell, flat(*each.grid, points[each.place].point)))
      patches[each.place] = cell.middle;
    else
      rest.push_back(each);
  }

  // 2. The others.
  for (const auto& [place, grid, cell] : rest) __builtin_prefetch(grid->patches_of(grid->cells[cell]).data());
  for (const auto& [place, grid, cell] : rest)
    for (const PatchIndex patch : grid->patches_of(grid->cells[cell])) __builtin_prefetch(&grid->outline(patch));
  for (const auto& [place, grid, cell] : rest) patches[place] = patch_in(*grid, points[place].point);
  return patches;
}

std::vector<PatchIndex> PatchLookup::patches_at(std::span<const SidePoint> points) const {
  for (const SidePoint& at : points) __builtin_prefetch(&mesh_.first_patch[side_slot(at.polygon, at.side)]);
  for (const SidePoint& at : points) __builtin_prefetch(&grid_of_[side_slot(at.polygon, at.side)]);
  // 1. Points that need no search in a cell; of the others the cell.
  std::vector<PatchIndex> patches(points.size(), no_patch);
  std::vector<Searched> searched;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto& [polygon, side, point] = points[k];
    const PatchRange range = mesh_.patches_on(polygon, side);
    if (range.begin == range.end) continue;
    if (range.end - range.begin == 1) {
      patches[k] = range.begin;
      continue;
    }
    const Grid& grid = grid_on(polygon, side);
    if (grid.lattice) {
      patches[k] = range.begin + grid.lattice->patch_at(point);
      continue;
    }
    searched.push_back({k, &grid, cell_index(grid, cell_at(grid, point))});
    __builtin_prefetch(&grid.cells[searched.back().cell]);
  }
  return with_searched(std::move(patches), searched, points);
}

}  // namespace patchlight
