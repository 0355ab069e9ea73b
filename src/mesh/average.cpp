#include "patchlight/mesh/average.h"

#include "patchlight/base/parallel.h"

#include <algorithm>
#include <cassert>
#include <vector>

namespace patchlight {
namespace {

// Boxes that are this share of their size apart may touch: patches of a tilted polygon do so within rounding.
constexpr double slack = 1e-9;

Box box_of(const PatchMesh& mesh, PatchIndex patch) {
  const PatchCorners corners = mesh.corner_points(patch);
  Box box;
  for (const Point& corner : std::span<const Point>(corners)) box.extend(corner);
  const Vector pad = Vector::Constant(slack * box.diagonal().norm());
  return {box.min() - pad, box.max() + pad};
}

// The patches of one side of a polygon in the order of their lower ends along the axis on which they reach farthest.
struct Row {
  struct Entry {
    Box box;
    PatchIndex patch;
  };
  int axis = 0;
  double longest = 0;  // of their boxes along the axis
  std::vector<Entry> entries;
};

Row row_of(const PatchMesh& mesh, PatchRange range) {
  Row row;
  Box bounds;
  for (PatchIndex patch = range.begin; patch < range.end; ++patch) {
    row.entries.push_back({box_of(mesh, patch), patch});
    bounds.extend(row.entries.back().box);
  }
  if (row.entries.empty()) return row;
  bounds.sizes().maxCoeff(&row.axis);
  for (const Row::Entry& entry : row.entries) row.longest = std::max(row.longest, entry.box.sizes()[row.axis]);
  const auto low = [&](const Row::Entry& entry) { return entry.box.min()[row.axis]; };
  std::stable_sort(row.entries.begin(), row.entries.end(),
                   [&](const auto& a, const auto& b) { return low(a) < low(b); });
  return row;
}

// Area in which two convex patches of one plane overlap: the one is cut by the planes that stand on the edges of the
// other (Sutherland and Hodgman 1974).
double overlap(const PatchCorners& patch, const Vector& normal, const PatchCorners& other) {
  const std::span<const Point> cut_by = patch;
  const std::span<const Point> whole = other;
  std::vector<Point> left(whole.begin(), whole.end());
  for (std::size_t k = 0; k < cut_by.size() && !left.empty(); ++k) {
    const Vector along = cut_by[(k + 1) % cut_by.size()] - cut_by[k];
    left = clip_to_half_space(left, cut_by[k], normal.cross(along));
  }
  return area_vector(left).norm();
}

// Calls visit(k, overlap) for the patches of `row` that may overlap a patch.
template <typename Visit>
void for_overlaps(const PatchMesh& mesh, PatchIndex patch, const PatchMesh& other, const Row& row, Visit visit) {
  const Box box = box_of(mesh, patch);
  const PatchCorners corners = mesh.corner_points(patch);
  const auto low = [&](const Row::Entry& entry, double end) { return entry.box.min()[row.axis] < end; };
  const auto first = std::lower_bound(row.entries.begin(), row.entries.end(), box.min()[row.axis] - row.longest, low);
  for (auto entry = first; entry != row.entries.end() && entry->box.min()[row.axis] <= box.max()[row.axis]; ++entry) {
    if (!entry->box.intersects(box)) continue;
    visit(entry->patch, overlap(corners, mesh.normal[patch], other.corner_points(entry->patch)));
  }
}

}  // namespace

Field average_over(const PatchMesh& mesh, const PatchMesh& other, const FieldView& values) {
  assert(values.rows() == other.size() && mesh.first_patch.size() == other.first_patch.size());
  std::vector<Row> rows;
  for (std::size_t slot = 0; slot + 1 < other.first_patch.size(); ++slot) {
    rows.push_back(row_of(other, {other.first_patch[slot], other.first_patch[slot + 1]}));
  }
  Field means = Field::Zero(mesh.size(), values.cols());
  parallel_for(mesh.size(), [&](std::size_t i) {
    const auto patch = static_cast<PatchIndex>(i);
    const Row& row = rows[2 * static_cast<std::size_t>(mesh.polygon[i]) + static_cast<std::size_t>(mesh.side[i])];
    double area = 0;
    for_overlaps(mesh, patch, other, row, [&](PatchIndex k, double common) {
      means.row(patch) += common * values.row(k);
      area += common;
    });
    assert(area > 0);
    means.row(patch) /= area;
  });
  return means;
}

}  // namespace patchlight
