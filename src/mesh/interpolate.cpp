#include "mesh/interpolate.h"

#include "base/parallel.h"
#include "base/tolerances.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

namespace patchlight {

std::span<const std::uint32_t> corner_vertices(const PatchMesh& mesh, PatchIndex patch) {
  const auto& corners = mesh.corners[patch];
  return std::span(corners).first(corners[3] == corners[2] ? 3 : 4);
}

// Sorted by counting.
PatchesAtVertices::PatchesAtVertices(const PatchMesh& mesh) : first_(mesh.vertices.size() + 1, 0) {
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    for (const std::uint32_t vertex : corner_vertices(mesh, i)) ++first_[vertex + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  patches_.resize(first_.back());
  std::vector<std::size_t> next = first_;
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    for (const std::uint32_t vertex : corner_vertices(mesh, i)) patches_[next[vertex]++] = i;
}

namespace {

// Patches of a tilted polygon touch but for rounding.
Box padded_box_of(const PatchMesh& mesh, PatchIndex patch) {
  const PatchCorners corners = mesh.corner_points(patch);
  Box box;
  for (const Point& corner : std::span<const Point>(corners)) box.extend(corner);
  const Vector pad = Vector::Constant(tolerance_of_shapes * box.diagonal().norm());
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
    row.entries.push_back({padded_box_of(mesh, patch), patch});
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

// The common part of two convex patches of one plane: the one is cut by the planes that stand on the edges of the other
// (Sutherland and Hodgman 1974).
std::vector<Point> overlap(std::span<const Point> cut_by, const Vector& normal, std::span<const Point> whole) {
  std::vector<Point> left(whole.begin(), whole.end());
  for (std::size_t k = 0; k < cut_by.size() && !left.empty(); ++k) {
    const Vector along = cut_by[(k + 1) % cut_by.size()] - cut_by[k];
    left = clip_to_half_space(left, cut_by[k], normal.cross(along));
  }
  return left;
}

// Calls visit(k, common outline) for the patches of `row` that may overlap a patch.
template <typename Visit>
void for_overlaps(const PatchMesh& mesh, PatchIndex patch, const PatchMesh& other, const Row& row, Visit visit) {
  const Box box = padded_box_of(mesh, patch);
  const PatchCorners corners = mesh.corner_points(patch);
  const auto low = [&](const Row::Entry& entry, double end) { return entry.box.min()[row.axis] < end; };
  const auto first = std::lower_bound(row.entries.begin(), row.entries.end(), box.min()[row.axis] - row.longest, low);
  for (auto entry = first; entry != row.entries.end() && entry->box.min()[row.axis] <= box.max()[row.axis]; ++entry) {
    if (!entry->box.intersects(box)) continue;
    visit(entry->patch, overlap(corners, mesh.normal[patch], other.corner_points(entry->patch)));
  }
}

std::vector<Row> rows_of(const PatchMesh& mesh) {
  std::vector<Row> rows;
  for (std::size_t slot = 0; slot + 1 < mesh.first_patch.size(); ++slot) {
    rows.push_back(row_of(mesh, {mesh.first_patch[slot], mesh.first_patch[slot + 1]}));
  }
  return rows;
}

// The middles of edges that are those of a patch still, in the order of the cuts.
std::vector<Middle> hanging(const PatchMesh& mesh) {
  if (mesh.middles.empty()) return {};
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& c : mesh.corners) {
    for (std::size_t k = 0; k < 4; ++k) edges.insert(std::minmax(c[k], c[(k + 1) % 4]));
  }
  std::vector<Middle> found;
  for (const Middle& middle : mesh.middles) {
    if (edges.contains(std::minmax(middle.ends[0], middle.ends[1]))) found.push_back(middle);
  }
  return found;
}

using Weights = std::array<double, 4>;

// Shares of the triangle's area opposite to each corner, clamped to the triangle.
Weights barycentric(const PatchCorners& patch, const Vector& normal, const Point& point) {
  const auto& [a, b, c, unused] = patch.points;
  const auto area = [&](const Point& q, const Point& r) {
    return std::max(0.0, normal.dot((q - point).cross(r - point)));
  };
  const double weight_a = area(b, c), weight_b = area(c, a), weight_c = area(a, b);
  const double sum = weight_a + weight_b + weight_c;
  return {weight_a / sum, weight_b / sum, weight_c / sum, 0};
}

// Solves q = s e + t f + s t g for the point q in the quadrilateral a, a + e, a + e + f + g, a + f.
// Eliminating s gives k2 t^2 + k1 t + k0 = 0; the root wanted is the one where the map's Jacobian
// k1 + 2 k2 t = sqrt(k1^2 - 4 k2 k0) is positive. It is taken in the form that does not cancel; k2 may be zero.
Weights inverse_bilinear(const PatchCorners& patch, const Vector& normal, const Point& point) {
  const auto& [a, b, c, d] = patch.points;
  const Vector e = b - a, f = d - a, g = (c - b) - (d - a), q = point - a;
  const auto cross = [&](const Vector& x, const Vector& y) { return normal.dot(x.cross(y)); };
  const double k2 = cross(g, f);
  const double k1 = cross(q, g) + cross(e, f);
  const double k0 = cross(q, e);
  const double jacobian = std::sqrt(std::max(0.0, k1 * k1 - 4 * k2 * k0));
  const double root = k1 >= 0 ? -2 * k0 / (k1 + jacobian) : (jacobian - k1) / (2 * k2);
  const double t = std::isfinite(root) ? std::clamp(root, 0.0, 1.0) : 0.0;
  const Vector along = e + t * g;
  const double s = std::clamp((q - t * f).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
}

}  // namespace

Field mean_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values) {
  const PatchesAtVertices at_vertex(mesh);
  Field means = Field::Zero(values.rows(), values.cols());
  parallel_for(mesh.size(), [&](std::size_t at) {
    const auto i = static_cast<PatchIndex>(at);
    auto sum = means.row(i);
    double areas = 0;
    for (const std::uint32_t vertex : corner_vertices(mesh, i)) {
      for (const PatchIndex j : at_vertex[vertex]) {
        if (mesh.normal[i].dot(mesh.normal[j]) < 0.9) continue;  // over 26 degrees: an edge of the shape
        sum += area[j] * values.row(j);
        areas += area[j];
      }
    }
    sum /= areas;
  });
  return means;
}

Field means_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values) {
  return mean_around(mesh, area, values.square()).sqrt();
}

Field average_over(const PatchMesh& mesh, const PatchMesh& other, Eigen::Index columns,
                   const std::function<Field(PatchIndex, const Point&)>& value) {
  assert(mesh.first_patch.size() == other.first_patch.size());
  const std::vector<Row> rows = rows_of(other);
  Field means = Field::Zero(mesh.size(), columns);
  parallel_for(mesh.size(), [&](std::size_t i) {
    const auto patch = static_cast<PatchIndex>(i);
    const Row& row = rows[side_slot(mesh.polygon[i], mesh.side[i])];
    double area = 0;
    for_overlaps(mesh, patch, other, row, [&](PatchIndex k, const std::vector<Point>& common) {
      const double share = area_vector(common).norm();
      if (share == 0) return;
      means.row(patch) += share * value(k, area_centroid(common));
      area += share;
    });
    assert(area > 0);
    means.row(patch) /= area;
  });
  return means;
}

Field average_over(const PatchMesh& mesh, const PatchMesh& other, const FieldView& values) {
  assert(values.rows() == other.size());
  return average_over(mesh, other, values.cols(), [&](PatchIndex k, const Point&) -> Field { return values.row(k); });
}

Field vertex_means(const PatchMesh& mesh, const FieldView& patch_values, const CornerWeights& weights) {
  Field sum = Field::Zero(static_cast<Eigen::Index>(mesh.vertices.size()), patch_values.cols());
  std::vector<double> total(mesh.vertices.size(), 0);
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    const std::span<const std::uint32_t> corners = corner_vertices(mesh, patch);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t vertex = corners[k];
      const double weight = weights(patch, static_cast<Eigen::Index>(k));
      sum.row(vertex) += weight * patch_values.row(patch);
      total[vertex] += weight;
    }
  }
  for (std::size_t vertex = 0; vertex < total.size(); ++vertex) {
    if (total[vertex] > 0) sum.row(static_cast<Eigen::Index>(vertex)) /= total[vertex];
  }
  // On the edge of a patch that was not cut a value between those at the edge's ends, as it has there itself. The ends
  // may hang on longer edges; these have been cut before.
  for (const Middle& middle : hanging(mesh))
    sum.row(middle.vertex) = (sum.row(middle.ends[0]) + sum.row(middle.ends[1])) / 2;
  return sum;
}

std::array<double, 4> interpolation_weights(const PatchMesh& mesh, PatchIndex patch, const Point& point) {
  const PatchCorners corners = mesh.corner_points(patch);
  const Vector& normal = mesh.normal[patch];
  return corners.count == 3 ? barycentric(corners, normal, point) : inverse_bilinear(corners, normal, point);
}

Eigen::Array<double, 1, Eigen::Dynamic> interpolate(const PatchMesh& mesh, const FieldView& vertex_values,
                                                    PatchIndex patch, const std::array<double, 4>& weights) {
  Eigen::Array<double, 1, Eigen::Dynamic> value = Eigen::Array<double, 1, Eigen::Dynamic>::Zero(vertex_values.cols());
  for (std::size_t k = 0; k < 4; ++k) value += weights[k] * vertex_values.row(mesh.corners[patch][k]);
  return value;
}

}  // namespace patchlight
