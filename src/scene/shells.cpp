#include "scene/shells.h"

#include "scene/extent.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

// One polygon walking along one edge, between welded vertices.
struct EdgeUse {
  std::uint32_t low, high;  // the vertices, low < high
  PolygonIndex polygon;
  bool upward;  // from low to high

  bool same_edge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

// Per vertex that a polygon uses the first of those with which it is welded.
std::vector<std::uint32_t> welded_vertices(const Scene& scene) {
  const std::vector<std::uint32_t> used = used_vertices(scene);
  const std::vector<std::uint32_t> stands_for = welded(corner_points(scene, used), weld_distance(scene));
  std::vector<std::uint32_t> place(scene.vertices.size(), 0);
  for (std::size_t k = 0; k < used.size(); ++k) place[used[k]] = used[stands_for[k]];
  return place;
}

// All edge uses, those of the same edge side by side.
std::vector<EdgeUse> edge_uses(const Scene& scene) {
  const std::vector<std::uint32_t> place = welded_vertices(scene);
  std::vector<EdgeUse> uses;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto& corners = scene.polygons[p].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t from = place[corners[k]];
      const std::uint32_t to = place[corners[(k + 1) % corners.size()]];
      if (from != to) uses.push_back({std::min(from, to), std::max(from, to), p, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::array{a.low, a.high, a.polygon} < std::array{b.low, b.high, b.polygon};
  });
  return uses;
}

// Calls visit(first, last) for the uses of every edge.
template <typename Visit>
void for_each_edge(const std::vector<EdgeUse>& uses, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].same_edge(uses[begin])) ++end;
    visit(uses.data() + begin, uses.data() + end);
  }
}

// A forest over the polygons. Every link leads to a smaller index or to itself, and stores whether the two have
// opposite orientations.
class Forest {
 public:
  explicit Forest(std::size_t size) : link_(size), turned_(size, 0) {
    std::iota(link_.begin(), link_.end(), PolygonIndex{0});
  }

  struct Root {
    PolygonIndex polygon;
    std::uint8_t turned;  // against the root
  };

  Root root(PolygonIndex polygon) {
    std::uint8_t turned = 0;
    while (link_[polygon] != polygon) {
      // Halve the path on the way.
      turned_[polygon] ^= turned_[link_[polygon]];
      turned ^= turned_[polygon];
      polygon = link_[polygon] = link_[link_[polygon]];
    }
    return {polygon, turned};
  }

  void join(PolygonIndex a, PolygonIndex b, bool turned) {
    const Root root_a = root(a);
    const Root root_b = root(b);
    if (root_a.polygon == root_b.polygon) return;
    const auto [low, high] = std::minmax(root_a.polygon, root_b.polygon);
    link_[high] = low;
    turned_[high] = root_a.turned ^ root_b.turned ^ static_cast<std::uint8_t>(turned);
  }

 private:
  std::vector<PolygonIndex> link_;
  std::vector<std::uint8_t> turned_;
};

// Per polygon 1 when it is turned against most of the area of those it is connected to by edges of two polygons.
std::vector<std::uint8_t> turned_polygons(const Scene& scene, const std::vector<EdgeUse>& uses) {
  const std::size_t count = scene.polygons.size();
  Forest forest(count);
  for_each_edge(uses, [&](const EdgeUse* first, const EdgeUse* last) {
    if (last - first == 2) forest.join(first[0].polygon, first[1].polygon, first[0].upward == first[1].upward);
  });
  std::vector<double> excess(count, 0);  // per root: the area turned like it minus that turned against it
  for (PolygonIndex p = 0; p < count; ++p) {
    const auto [root, turned] = forest.root(p);
    const double area = polygon_area(scene, p);
    excess[root] += turned ? -area : area;
  }
  std::vector<std::uint8_t> result(count);
  for (PolygonIndex p = 0; p < count; ++p) {
    const auto [root, turned] = forest.root(p);
    result[p] = excess[root] < 0 ? turned ^ 1U : turned;
  }
  return result;
}

std::vector<PolygonIndex> connected(std::size_t count, const std::vector<EdgeUse>& uses) {
  Forest forest(count);
  for_each_edge(uses, [&](const EdgeUse* first, const EdgeUse* last) {
    for (const EdgeUse* use = first + 1; use < last; ++use) forest.join(first->polygon, use->polygon, false);
  });
  std::vector<PolygonIndex> shell(count);
  for (PolygonIndex p = 0; p < count; ++p) shell[p] = forest.root(p).polygon;
  return shell;
}

}  // namespace

Shells shells_of(const Scene& scene) {
  const std::vector<EdgeUse> uses = edge_uses(scene);
  Shells shells;
  shells.shell = connected(scene.polygons.size(), uses);
  shells.turned = turned_polygons(scene, uses);

  // Per first polygon of a shell.
  std::vector<std::uint8_t> consistent(scene.polygons.size(), 1);
  std::vector<std::uint8_t> has_rim(scene.polygons.size(), 0);
  for_each_edge(uses, [&](const EdgeUse* first, const EdgeUse* last) {
    const auto goes_up = [&](const EdgeUse& use) { return use.upward != (shells.turned[use.polygon] != 0); };
    const PolygonIndex shell = shells.shell[first->polygon];
    if (last - first == 1) {
      has_rim[shell] = 1;
      const auto [from, to] = goes_up(*first) ? std::pair(first->low, first->high) : std::pair(first->high, first->low);
      shells.rim.push_back({first->polygon, from, to});
    } else if (last - first != 2 || goes_up(first[0]) == goes_up(first[1])) {
      consistent[shell] = 0;
    }
    if (last - first <= 2) return;
    ++shells.branched_edges;
    for (const EdgeUse* use = first; use < last; ++use) shells.branched.push_back(use->polygon);
  });
  std::sort(shells.branched.begin(), shells.branched.end());
  shells.branched.erase(std::unique(shells.branched.begin(), shells.branched.end()), shells.branched.end());

  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const PolygonIndex shell = shells.shell[p];
    shells.closed.push_back(consistent[shell] && !has_rim[shell]);
    shells.rimmed.push_back(consistent[shell] && has_rim[shell]);
    shells.count += shell == p;
    shells.closed_count += shell == p && shells.closed[p];
  }
  return shells;
}

}  // namespace patchlight
