#include "mesh/nested_mesh.h"

#include "mesh/interpolate.h"
#include "mesh/outline.h"

#include <Eigen/Geometry>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

namespace patchlight {
namespace {

// The same for both sides, which have their own vertices at the same places.
using SideCorners = std::array<Point, 4>;

SideCorners sorted_corners(PatchCorners corners) {
  // A triangle repeats its last corner.
  std::sort(corners.points.begin(), corners.points.begin() + corners.count, comes_before);
  if (corners.count == 3) corners.points[3] = corners.points[2];
  return corners.points;
}

struct CornersComeBefore {
  bool operator()(const SideCorners& a, const SideCorners& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), comes_before);
  }
};

using CornerIndices = std::array<std::uint32_t, 4>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the smaller index first

Edge edge_of(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

std::vector<Edge> patch_edges(const PatchMesh& mesh, PatchIndex patch) {
  const std::span<const std::uint32_t> corners = corner_vertices(mesh, patch);
  std::vector<Edge> edges;
  for (std::size_t k = 0; k < corners.size(); ++k)
    edges.push_back(edge_of(corners[k], corners[(k + 1) % corners.size()]));
  return edges;
}

struct EdgeHash {
  // The golden ratio's bits spread neighboring indices.
  std::size_t operator()(const Edge& edge) const {
    return ((std::uint64_t{edge.first} << 32 | edge.second) * 0x9e3779b97f4a7c15u) >> 16;
  }
};

// The middles of cut edges.
using Middles = std::unordered_map<Edge, std::uint32_t, EdgeHash>;

Middles middles_of(const PatchMesh& mesh) {
  Middles middles;
  middles.reserve(mesh.middles.size());
  for (const Middle& middle : mesh.middles) middles.emplace(edge_of(middle.ends[0], middle.ends[1]), middle.vertex);
  return middles;
}

// Whether one of these edges is cut and one of its halves is cut, or will be.
bool has_quarters(const std::vector<Edge>& edges, const Middles& middles, const std::set<Edge>& to_cut) {
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    const auto middle = middles.find(edge);
    if (middle == middles.end()) return false;
    const Edge halves[] = {edge_of(edge.first, middle->second), edge_of(middle->second, edge.second)};
    return std::any_of(std::begin(halves), std::end(halves),
                       [&](const Edge& half) { return middles.contains(half) || to_cut.contains(half); });
  });
}

// The marks with those that keep the sides of sheets alike.
std::vector<std::uint8_t> on_both_sides(const PatchMesh& mesh, std::span<const std::uint8_t> marked) {
  std::vector<std::uint8_t> all(marked.begin(), marked.end());
  const std::vector<PatchIndex> other_side = other_sides(mesh);
  for (PatchIndex i = 0; i < other_side.size(); ++i) {
    if (marked[i]) all[other_side[i]] = 1;
  }
  return all;
}

// The marks with those that keep neighbors one level apart.
std::vector<std::uint8_t> balanced(const PatchMesh& mesh, std::span<const std::uint8_t> marked) {
  std::vector<std::uint8_t> all = on_both_sides(mesh, marked);
  if (mesh.middles.empty()) return all;
  const std::vector<PatchIndex> other_side = other_sides(mesh);
  const Middles middles = middles_of(mesh);
  std::set<Edge> to_cut;
  const auto mark = [&](PatchIndex patch) {
    all[patch] = 1;
    for (const Edge& edge : patch_edges(mesh, patch)) to_cut.insert(edge);
  };
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (all[i]) mark(i);
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      if (all[i] || !has_quarters(patch_edges(mesh, i), middles, to_cut)) continue;
      mark(i);
      if (!other_side.empty()) mark(other_side[i]);
      changed = true;
    }
  }
  return all;
}

// A copy of a patch with other corners.
void add_patch(PatchMesh& to, const PatchMesh& from, PatchIndex patch, const CornerIndices& corners) {
  to.corners.push_back(corners);
  to.centroid.push_back(from.centroid[patch]);
  to.normal.push_back(from.normal[patch]);
  to.area.push_back(from.area[patch]);
  to.material.push_back(from.material[patch]);
  to.polygon.push_back(from.polygon[patch]);
  to.side.push_back(from.side[patch]);
}

// A mesh to which patches are added.
class Cutter {
 public:
  explicit Cutter(const PatchMesh& mesh) : middles_(middles_of(mesh)) {
    result_.mesh.vertices = mesh.vertices;
    result_.mesh.middles = mesh.middles;
    result_.mesh.sheets = mesh.sheets;
  }

  void add_whole(const PatchMesh& from, PatchIndex patch) {
    add_patch(result_.mesh, from, patch, from.corners[patch]);
    result_.parent.push_back(patch);
  }

  void add_part(const PatchMesh& from, PatchIndex patch, const CornerIndices& corners) {
    PatchMesh& mesh = result_.mesh;
    add_patch(mesh, from, patch, corners);
    const PatchCorners points = mesh.corner_points(mesh.size() - 1);
    mesh.centroid.back() = area_centroid(points);
    mesh.area.back() = area_vector(points).norm();
    result_.parent.push_back(patch);
  }

  std::array<CornerIndices, 4> quarters(const CornerIndices& c, bool is_triangle) {
    const std::uint32_t ab = middle(c[0], c[1]);
    const std::uint32_t bc = middle(c[1], c[2]);
    if (is_triangle) {
      const std::uint32_t ca = middle(c[2], c[0]);
      return {{{c[0], ab, ca, ca}, {ab, c[1], bc, bc}, {ca, bc, c[2], c[2]}, {ab, bc, ca, ca}}};
    }
    const std::uint32_t cd = middle(c[2], c[3]);
    const std::uint32_t da = middle(c[3], c[0]);
    // The middles of opposite edges bisect each other.
    const std::uint32_t center = add_vertex((at(ab) + at(cd)) / 2);
    return {{{c[0], ab, center, da}, {ab, c[1], bc, center}, {center, bc, c[2], cd}, {da, center, cd, c[3]}}};
  }

  PatchIndex size() const { return result_.mesh.size(); }
  Refinement take() { return std::move(result_); }
  std::vector<PatchIndex>& first_patch() { return result_.mesh.first_patch; }

 private:
  const Point& at(std::uint32_t vertex) const { return result_.mesh.vertices[vertex]; }

  std::uint32_t add_vertex(const Point& point) {
    result_.mesh.vertices.push_back(point);
    return static_cast<std::uint32_t>(result_.mesh.vertices.size() - 1);
  }

  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const auto [place, is_new] =
        middles_.try_emplace(edge_of(a, b), static_cast<std::uint32_t>(result_.mesh.vertices.size()));
    if (is_new) {
      add_vertex((at(a) + at(b)) / 2);
      result_.mesh.middles.push_back({place->second, {a, b}});
    }
    return place->second;
  }

  Middles middles_;
  Refinement result_;
};

std::vector<std::uint8_t> large_patches(const PatchMesh& mesh, double usual_edge) {
  std::vector<double> edges;
  for (PatchIndex i = 0; i < mesh.size(); ++i) edges.push_back(std::sqrt(longest_edge_squared(mesh.corner_points(i))));
  const double longest = edges.empty() ? 0 : std::min(usual_edge, *std::max_element(edges.begin(), edges.end()));
  std::vector<std::uint8_t> large;
  for (const double edge : edges) large.push_back(parts_of_parent(edge, longest) > 1 ? 1 : 0);
  return large;
}

NestedMesh nest(PatchMesh parents, std::span<const std::uint8_t> is_cut) {
  Refinement refined = refine(parents, is_cut);
  NestedMesh mesh{std::move(parents), std::move(refined.mesh), std::move(refined.parent), {}};
  for (PatchIndex i = 0; i < mesh.patches.size(); ++i) {
    if (i == 0 || mesh.parent[i] != mesh.parent[i - 1]) mesh.first_patch.push_back(i);
  }
  mesh.first_patch.push_back(mesh.patches.size());
  return mesh;
}

// A mesh each patch of which is cut so many times, and others as in refine().
Refinement refined(const PatchMesh& mesh, std::vector<std::uint8_t> cuts) {
  Refinement result{mesh, std::vector<PatchIndex>(mesh.size())};
  std::iota(result.parent.begin(), result.parent.end(), PatchIndex{0});
  while (std::any_of(cuts.begin(), cuts.end(), [](std::uint8_t more) { return more > 0; })) {
    Refinement once = refine(result.mesh, cuts);
    std::vector<std::uint8_t> left;
    for (PatchIndex& parent : once.parent) {
      left.push_back(cuts[parent] > 0 ? cuts[parent] - 1 : 0);
      parent = result.parent[parent];
    }
    cuts = std::move(left);
    result = std::move(once);
  }
  return result;
}

// The middle of the edge that begins at a corner.
Point middle(const PatchCorners& patch, int corner) {
  const auto next = static_cast<std::size_t>((corner + 1) % patch.count);
  return (patch.points[static_cast<std::size_t>(corner)] + patch.points[next]) / 2;
}

PatchCorners triangle(const Point& a, const Point& b, const Point& c) { return {{a, b, c, c}, 3}; }

bool is_left_of(const Point& from, const Point& to, const Vector& normal, const Point& point) {
  return normal.dot((to - from).cross(point - from)) > 0;
}

}  // namespace

std::vector<PatchIndex> other_sides(const PatchMesh& mesh) {
  if (mesh.sheets.empty()) return {};
  std::vector<PatchIndex> other_side(mesh.size());
  std::iota(other_side.begin(), other_side.end(), PatchIndex{0});
  for (const PolygonIndex sheet : mesh.sheets) {
    std::map<SideCorners, PatchIndex, CornersComeBefore> fronts;
    const PatchRange front = mesh.patches_on(sheet, Side::front);
    for (PatchIndex i = front.begin; i < front.end; ++i) fronts.emplace(sorted_corners(mesh.corner_points(i)), i);
    const PatchRange back = mesh.patches_on(sheet, Side::back);
    for (PatchIndex j = back.begin; j < back.end; ++j) {
      const auto found = fronts.find(sorted_corners(mesh.corner_points(j)));
      if (found == fronts.end()) continue;
      other_side[j] = found->second;
      other_side[found->second] = j;
    }
  }
  return other_side;
}

Refinement refine(const PatchMesh& mesh, std::span<const std::uint8_t> marked) {
  assert(marked.size() == mesh.size());
  const std::vector<std::uint8_t> cut = balanced(mesh, marked);
  Cutter cutter(mesh);
  std::size_t slot = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (; slot < mesh.first_patch.size() && mesh.first_patch[slot] <= i; ++slot)
      cutter.first_patch().push_back(cutter.size());
    if (!cut[i]) {
      cutter.add_whole(mesh, i);
      continue;
    }
    for (const CornerIndices& corners : cutter.quarters(mesh.corners[i], mesh.corner_points(i).count == 3))
      cutter.add_part(mesh, i, corners);
  }
  for (; slot < mesh.first_patch.size(); ++slot) cutter.first_patch().push_back(cutter.size());
  return cutter.take();
}

PatchMesh refine(const PatchMesh& mesh) { return refine(mesh, std::vector<std::uint8_t>(mesh.size(), 1)).mesh; }

// Edges below a quarter of the longest stay whole.
std::size_t parts_of_parent(double edge, double longest) { return edge >= 0.25 * longest ? 4 : 1; }

NestedMesh nest(PatchMesh parents, double usual_edge) {
  const std::vector<std::uint8_t> large = large_patches(parents, usual_edge);
  return nest(std::move(parents), large);
}

PatchIndex number_kept(std::span<const PatchIndex> places) {
  return static_cast<PatchIndex>(places.size() -
                                 static_cast<std::size_t>(std::count(places.begin(), places.end(), no_patch)));
}

FinerMesh cut_patches(const NestedMesh& mesh, std::span<const std::uint8_t> cuts) {
  assert(cuts.size() == mesh.parents.size());
  const auto patches_before = [&](PatchIndex parent) {
    return mesh.first_patch[parent + 1] - mesh.first_patch[parent];
  };

  // 1. Parents as often as their patches; one that was whole gets parts first.
  std::vector<std::uint8_t> of_parents;
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g)
    of_parents.push_back(cuts[g] > 0 && patches_before(g) == 1 ? cuts[g] - 1 : cuts[g]);
  Refinement parents = refined(mesh.parents, std::move(of_parents));
  std::vector<PatchIndex> parts(mesh.parents.size(), 0);
  for (const PatchIndex before : parents.parent) ++parts[before];

  // 2. Whole parents stay so until they are cut; then they are parents as others are.
  std::vector<std::uint8_t> is_cut;
  for (const PatchIndex before : parents.parent)
    is_cut.push_back(parts[before] > 1 || patches_before(before) > 1 || cuts[before] > 0 ? 1 : 0);
  FinerMesh finer{nest(std::move(parents.mesh), is_cut), {}, {}};

  // 3. Which patches are as they were.
  for (const PatchIndex parent : finer.mesh.parent) finer.parent_before.push_back(parents.parent[parent]);
  finer.place.assign(finer.mesh.patches.size(), no_patch);
  for (PatchIndex g = 0; g < finer.mesh.parents.size(); ++g) {
    const PatchRange now = finer.mesh.patches_of(g);
    const PatchIndex before = parents.parent[g];
    if (parts[before] != 1 || now.end - now.begin != patches_before(before)) continue;
    for (PatchIndex k = 0; k < now.end - now.begin; ++k) finer.place[now.begin + k] = mesh.first_patch[before] + k;
  }
  return finer;
}

FinerMesh refine(const NestedMesh& mesh, std::span<const std::uint8_t> marked_parents) {
  std::vector<std::uint8_t> cuts;
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g) {
    const bool is_whole = mesh.first_patch[g + 1] - mesh.first_patch[g] == 1;
    cuts.push_back(marked_parents[g] == 0 ? 0 : is_whole ? 2 : 1);
  }
  return cut_patches(mesh, cuts);
}

Field summed_by_parent(const NestedMesh& mesh, const FieldView& values) {
  assert(values.rows() == static_cast<Eigen::Index>(mesh.patches.size()));
  Field sums = Field::Zero(mesh.parents.size(), values.cols());
  for (PatchIndex i = 0; i < mesh.patches.size(); ++i) sums.row(mesh.parent[i]) += values.row(i);
  return sums;
}

Field means_by_parent(const NestedMesh& mesh, const FieldView& values, const Eigen::VectorXd& area) {
  const Field areas = summed_by_parent(mesh, area.array());
  return summed_by_parent(mesh, values.colwise() * area.array()).colwise() / areas.col(0);
}

Field of_parents(const NestedMesh& mesh, const FieldView& parent_values) {
  Field values(mesh.patches.size(), parent_values.cols());
  for (PatchIndex i = 0; i < mesh.patches.size(); ++i) values.row(i) = parent_values.row(mesh.parent[i]);
  return values;
}

double mean_area(std::span<const double> areas) {
  return std::accumulate(areas.begin(), areas.end(), 0.0) / static_cast<double>(areas.size());
}

double mean_area(const PatchMesh& mesh) { return mean_area(std::span<const double>(mesh.area)); }

double small_area(const PatchMesh& mesh) { return mean_area(mesh) / 16; }

PatchMesh without_patches(const PatchMesh& mesh, std::span<const std::uint8_t> is_left_out) {
  assert(is_left_out.size() == mesh.size() && mesh.middles.empty());
  std::vector<std::uint8_t> is_used(mesh.vertices.size(), 0);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (is_left_out[i]) continue;
    for (const std::uint32_t vertex : mesh.corners[i]) is_used[vertex] = 1;
  }
  PatchMesh kept;
  kept.sheets = mesh.sheets;
  std::vector<std::uint32_t> number;  // per vertex, among those that are kept
  for (std::size_t v = 0; v < is_used.size(); ++v) {
    number.push_back(static_cast<std::uint32_t>(kept.vertices.size()));
    if (is_used[v]) kept.vertices.push_back(mesh.vertices[v]);
  }
  std::size_t slot = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (; mesh.first_patch[slot] <= i; ++slot) kept.first_patch.push_back(kept.size());
    if (is_left_out[i]) continue;
    CornerIndices corners = mesh.corners[i];
    for (std::uint32_t& corner : corners) corner = number[corner];
    add_patch(kept, mesh, i, corners);
  }
  for (; slot < mesh.first_patch.size(); ++slot) kept.first_patch.push_back(kept.size());
  return kept;
}

PatchCorners quarter_of(const PatchCorners& patch, int quarter) {
  const auto& c = patch.points;
  const Point ab = middle(patch, 0), bc = middle(patch, 1);
  if (patch.count == 3) {
    const Point ca = middle(patch, 2);
    if (quarter == 0) return triangle(c[0], ab, ca);
    if (quarter == 1) return triangle(ab, c[1], bc);
    return quarter == 2 ? triangle(ca, bc, c[2]) : triangle(ab, bc, ca);
  }
  const Point cd = middle(patch, 2), da = middle(patch, 3);
  const Point center = (ab + cd) / 2;
  if (quarter == 0) return {{c[0], ab, center, da}, 4};
  if (quarter == 1) return {{ab, c[1], bc, center}, 4};
  return quarter == 2 ? PatchCorners{{center, bc, c[2], cd}, 4} : PatchCorners{{da, center, cd, c[3]}, 4};
}

int quarter_at(const PatchCorners& patch, const Vector& normal, const Point& point) {
  const Point ab = middle(patch, 0), bc = middle(patch, 1);
  if (patch.count == 3) {
    const Point ca = middle(patch, 2);
    if (is_left_of(ca, ab, normal, point) == is_left_of(ca, ab, normal, patch.points[0])) return 0;
    if (is_left_of(ab, bc, normal, point) == is_left_of(ab, bc, normal, patch.points[1])) return 1;
    return is_left_of(bc, ca, normal, point) == is_left_of(bc, ca, normal, patch.points[2]) ? 2 : 3;
  }
  // The line through the middles of the second and the last edge divides the corners 0 and 1 from 2 and 3.
  const Point cd = middle(patch, 2), da = middle(patch, 3);
  const bool near_first_edge = is_left_of(bc, da, normal, point) == is_left_of(bc, da, normal, patch.points[0]);
  const bool near_last_edge = is_left_of(ab, cd, normal, point) == is_left_of(ab, cd, normal, patch.points[0]);
  if (near_first_edge) return near_last_edge ? 0 : 1;
  return near_last_edge ? 3 : 2;
}

}  // namespace patchlight
