#include "mesh/patch_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace patchlight {
namespace {

// Points this share of the polygon side's extent outside of a patch still find it.
constexpr double lookup_slack = 4e-6;

// The patches of a lattice are at their places up to this share of their edges.
constexpr double lattice_tolerance = 1e-6;

using Flat = Eigen::Vector2d;

double cross(const Flat& a, const Flat& b) { return a.x() * b.y() - a.y() * b.x(); }

double distance_to_edge(const Flat& point, const Flat& from, const Flat& to) {
  const Flat edge = to - from;
  const double t = std::clamp((point - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (from + t * edge - point).norm();
}

// Zero inside. The patch is convex and counter-clockwise in the flat coordinates; an edge without length bounds
// nothing.
double distance_to(const auto& outline, const Flat& eye) {
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    const Flat from(outline.u[k], outline.v[k]);
    const Flat to(outline.u[next], outline.v[next]);
    if (cross(to - from, eye - from) >= 0) continue;
    inside = false;
    nearest = std::min(nearest, distance_to_edge(eye, from, to));
  }
  return inside ? 0 : nearest;
}

struct Cell {
  int u, v;
};

// The cell at a point; the closest one for a point outside.
Cell cell_at(const auto& grid, const Point& point) {
  const double u = (point[grid.axis_u] - grid.lower_u) * grid.cells_per_u;
  const double v = (point[grid.axis_v] - grid.lower_v) * grid.cells_per_v;
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

// Do the corners of a parallelogram lie at -1/2 and 1/2 along both directions, counted from its centroid?
bool is_cell(const PatchMesh& mesh, PatchIndex patch, const Vector& to_u, const Vector& to_v) {
  const PatchCorners corners = mesh.corner_points(patch);
  return corners.count == 4 && std::all_of(corners.points.begin(), corners.points.end(), [&](const Point& corner) {
           const Vector from = corner - mesh.centroid[patch];
           return std::abs(std::abs(from.dot(to_u)) - 0.5) <= lattice_tolerance &&
                  std::abs(std::abs(from.dot(to_v)) - 0.5) <= lattice_tolerance;
         });
}

}  // namespace

std::optional<PatchLookup::Lattice> PatchLookup::lattice_of(PatchRange range) const {
  // 1. The first row, as long as centroids are evenly spaced; then the step from row to row.
  const PatchIndex count = range.end - range.begin;
  const Point& first = mesh_.centroid[range.begin];
  const Vector u = mesh_.centroid[range.begin + 1] - first;
  const auto is_at = [&](PatchIndex k, const Point& place) {
    return (mesh_.centroid[range.begin + k] - place).norm() <= lattice_tolerance * u.norm();
  };
  PatchIndex row = 1;
  while (row < count && is_at(row, first + row * u)) ++row;
  if (count % row != 0) return std::nullopt;
  const PatchCorners corners = mesh_.corner_points(range.begin);
  const Vector edge = corners.points[1] - corners.points[0];
  const Vector other = corners.points[3] - corners.points[0];
  const Vector v = row < count                                    ? Vector(mesh_.centroid[range.begin + row] - first)
                   : edge.cross(u).norm() > other.cross(u).norm() ? edge
                                                                  : other;

  // 2. All of them are parallelograms in their places. The dual vectors: u . to_u = 1, v . to_u = 0.
  const Vector normal = u.cross(v);
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) return std::nullopt;
  const Vector to_u = v.cross(normal) / squared;
  const Vector to_v = normal.cross(u) / squared;
  for (PatchIndex k = 0; k < count; ++k) {
    if (!is_at(k, first + k % row * u + k / row * v) || !is_cell(mesh_, range.begin + k, to_u, to_v))
      return std::nullopt;
  }
  return Lattice{first - 0.5 * u - 0.5 * v, to_u, to_v, static_cast<int>(row), static_cast<int>(count / row)};
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
    outline.u[k] = corners.points[k][grid.axis_u];
    outline.v[k] = corners.points[k][grid.axis_v];
  }
  return outline;
}

PatchLookup::Grid PatchLookup::make_grid(PatchRange range) const {
  if (auto lattice = lattice_of(range)) {
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
  const auto for_cells_of = [&](PatchIndex patch, const auto& visit) {
    const Box box = box_of(mesh_, patch);
    const Cell low = cell_at(grid, box.min() - pad);
    const Cell high = cell_at(grid, box.max() + pad);
    for (int v = low.v; v <= high.v; ++v) {
      for (int u = low.u; u <= high.u; ++u) visit(grid.begin[cell_index(grid, {u, v})]);
    }
  };
  grid.begin.assign(static_cast<std::size_t>(grid.count_u) * static_cast<std::size_t>(grid.count_v) + 1, 0);
  for (PatchIndex patch = range.begin; patch < range.end; ++patch) {
    for_cells_of(patch, [](std::uint32_t& entry) { ++entry; });
  }
  std::partial_sum(grid.begin.begin(), grid.begin.end(), grid.begin.begin());
  grid.patches.resize(grid.begin.back());
  for (PatchIndex patch = range.end; patch-- > range.begin;) {
    for_cells_of(patch, [&](std::uint32_t& entry) { grid.patches[--entry] = patch; });
  }
  return grid;
}

PatchIndex PatchLookup::patch_in(const Lattice& lattice, const Point& point) {
  const Vector to = point - lattice.origin;
  const auto place = [](double at, int count) { return static_cast<int>(std::clamp(at, 0.0, count - 0.5)); };
  const int column = place(to.dot(lattice.to_u), lattice.count_u);
  const int row = place(to.dot(lattice.to_v), lattice.count_v);
  return static_cast<PatchIndex>(row * lattice.count_u + column);
}

PatchIndex PatchLookup::patch_in(const Grid& grid, const Point& point) {
  const Flat eye(point[grid.axis_u], point[grid.axis_v]);
  PatchIndex nearest = no_patch;
  double shortest = std::numeric_limits<double>::infinity();
  const auto search_cell = [&](Cell cell) {
    if (cell.u < 0 || cell.u >= grid.count_u || cell.v < 0 || cell.v >= grid.count_v) return;
    const std::size_t index = cell_index(grid, cell);
    for (std::uint32_t k = grid.begin[index]; k < grid.begin[index + 1] && shortest > 0; ++k) {
      const double distance = distance_to(grid.outlines[grid.patches[k] - grid.first], eye);
      if (distance < shortest) shortest = distance, nearest = grid.patches[k];
    }
  };

  // The point's cell or, when that is empty, the closest ring of cells around it that is not.
  const Cell home = cell_at(grid, point);
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
  return grids_[grid_of_[2 * static_cast<std::size_t>(polygon) + static_cast<std::size_t>(side)]];
}

std::optional<PatchIndex> PatchLookup::patch_at(PolygonIndex polygon, Side side, const Point& point) const {
  const PatchRange range = mesh_.patches_on(polygon, side);
  if (range.begin == range.end) return std::nullopt;
  if (range.end - range.begin == 1) return range.begin;
  const Grid& grid = grid_on(polygon, side);
  return grid.lattice ? range.begin + patch_in(*grid.lattice, point) : patch_in(grid, point);
}

// Starts to read the patches of each cell, and then their outlines.
void PatchLookup::prefetch(std::span<const Searched> searched) {
  constexpr std::uint32_t in_a_line = 16;
  for (const auto& [place, grid, cell] : searched) {
    for (std::uint32_t at = grid->begin[cell]; at < grid->begin[cell + 1]; at += in_a_line)
      __builtin_prefetch(&grid->patches[at]);
  }
  for (const auto& [place, grid, cell] : searched) {
    for (std::uint32_t at = grid->begin[cell]; at < grid->begin[cell + 1]; ++at)
      __builtin_prefetch(&grid->outlines[grid->patches[at] - grid->first]);
  }
}

std::vector<PatchIndex> PatchLookup::patches_at(std::span<const SidePoint> points) const {
  const auto slot_of = [](const SidePoint& at) {
    return 2 * static_cast<std::size_t>(at.polygon) + static_cast<std::size_t>(at.side);
  };
  for (const SidePoint& at : points) __builtin_prefetch(&mesh_.first_patch[slot_of(at)]);
  for (const SidePoint& at : points) __builtin_prefetch(&grid_of_[slot_of(at)]);
  // 1. What needs no search in a cell; of the others the cell.
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
      patches[k] = range.begin + patch_in(*grid.lattice, point);
      continue;
    }
    searched.push_back({k, &grid, cell_index(grid, cell_at(grid, point))});
    __builtin_prefetch(&grid.begin[searched.back().cell]);
  }

  // 2. What does.
  prefetch(searched);
  for (const auto& [k, grid, cell] : searched) patches[k] = patch_in(*grid, points[k].point);
  return patches;
}

}  // namespace patchlight
