#include "scene/joined_faces.h"

#include "base/disjoint_sets.h"
#include "scene/extent.h"
#include "scene/pieces.h"
#include "scene/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace patchlight {
namespace {

constexpr double same_direction = 1e-4;  // radians
constexpr std::size_t most_joined_corners = 2000;

using Slot = std::uint32_t;  // a corner of a polygon, and the edge that begins there
constexpr Slot no_slot = ~Slot{0};

// All corners of all polygons one after the other, as loops that can be joined.
struct Loops {
  std::vector<std::uint32_t> vertex;  // per slot
  std::vector<PolygonIndex> polygon;
  std::vector<Slot> next;
  std::vector<Slot> before;
  std::vector<Slot> mate;   // the same edge of the polygon beside, walked the other way, where the two can become one
  std::vector<Slot> first;  // per polygon
};

Loops loops_of(const Scene& scene) {
  Loops loops;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto begin = static_cast<Slot>(loops.vertex.size());
    const auto count = static_cast<Slot>(scene.polygons[p].corners.size());
    loops.first.push_back(begin);
    for (Slot k = 0; k < count; ++k) {
      loops.vertex.push_back(scene.polygons[p].corners[k]);
      loops.polygon.push_back(p);
      loops.next.push_back(begin + (k + 1) % count);
      loops.before.push_back(begin + (k + count - 1) % count);
    }
  }
  loops.mate.assign(loops.vertex.size(), no_slot);
  return loops;
}

// How far apart two polygons of one picture may have a point in it: a hundredth of a texel of most pictures, and more
// than six digits of coordinates leave open.
constexpr double same_texture_place = 1e-5;

// True when one side of two polygons lies in the picture of its material as if both were one.
bool continue_picture(const Scene& scene, const Polygon& a, const Polygon& b, Side side) {
  const TextureMap* one = texture_map_on(scene, a, side);
  const TextureMap* other = texture_map_on(scene, b, side);
  if (!one || !other) return one == other;
  for (const Polygon* polygon : {&a, &b}) {
    for (const std::uint32_t corner : polygon->corners) {
      const Point& at = scene.vertices[corner];
      if (!((one->linear * at + one->offset - other->linear * at - other->offset).norm() <= same_texture_place))
        return false;
    }
  }
  return true;
}

bool continue_pictures(const Scene& scene, const Polygon& a, const Polygon& b) {
  return continue_picture(scene, a, b, Side::front) && continue_picture(scene, a, b, Side::back);
}

bool are_alike(const Scene& scene, const std::vector<Vector>& normals, PolygonIndex p, PolygonIndex q) {
  const Polygon& a = scene.polygons[p];
  const Polygon& b = scene.polygons[q];
  return p != q && a.material == b.material && a.back_material == b.back_material && a.group == b.group &&
         a.file == b.file && (normals[p] - normals[q]).norm() <= same_direction && continue_pictures(scene, a, b);
}

// Finds the edges that two alike polygons of one plane share, and no third one.
void find_mates(Loops& loops, const Scene& scene, const std::vector<Vector>& normals) {
  struct Use {
    std::uint64_t edge;
    Slot slot;
    bool operator<(const Use& other) const { return std::tie(edge, slot) < std::tie(other.edge, other.slot); }
  };
  std::vector<Use> uses(loops.vertex.size());
  for (Slot slot = 0; slot < uses.size(); ++slot) {
    const auto [low, high] = std::minmax(loops.vertex[slot], loops.vertex[loops.next[slot]]);
    uses[slot] = {std::uint64_t{low} << 32 | high, slot};
  }
  std::sort(uses.begin(), uses.end());
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].edge == uses[begin].edge) ++end;
    if (end - begin != 2) continue;
    const Slot a = uses[begin].slot;
    const Slot b = uses[begin + 1].slot;
    if (loops.vertex[a] == loops.vertex[b] || !are_alike(scene, normals, loops.polygon[a], loops.polygon[b])) continue;
    loops.mate[a] = b;
    loops.mate[b] = a;
  }
}

// Leaves out an edge of two loops, which become one, or a spike out and back of one loop.
void leave_out(Loops& loops, Slot a, Slot b) {
  const auto link = [&loops](Slot from, Slot to) {
    loops.next[from] = to;
    loops.before[to] = from;
  };
  const Slot before_a = loops.before[a];
  const Slot before_b = loops.before[b];
  const Slot after_a = loops.next[a];
  const Slot after_b = loops.next[b];
  if (after_a != b) link(before_b, after_a);
  if (after_b != a) link(before_a, after_b);
  loops.mate[a] = loops.mate[b] = no_slot;
  loops.next[a] = loops.next[b] = no_slot;
}

// Leaves out edges that a loop walks along to and fro at once, until there are none.
void leave_out_spikes(Loops& loops) {
  for (Slot slot = 0; slot < loops.vertex.size(); ++slot) {
    for (Slot a = slot; loops.next[a] != no_slot && loops.mate[a] != no_slot;) {
      const Slot b = loops.mate[a];
      if (loops.next[a] != b && loops.next[b] != a) break;
      const Slot root = loops.next[a] == b ? loops.before[a] : loops.before[b];
      leave_out(loops, a, b);
      a = root;
    }
  }
}

// The polygons that become one, each list with its first in front.
std::vector<std::vector<PolygonIndex>> joined_groups(Loops& loops, std::size_t polygons) {
  DisjointSets groups(polygons);
  for (Slot a = 0; a < loops.vertex.size(); ++a) {
    const Slot b = loops.mate[a];
    if (b != no_slot && a < b && groups.join(loops.polygon[a], loops.polygon[b])) leave_out(loops, a, b);
  }
  leave_out_spikes(loops);
  std::vector<std::vector<PolygonIndex>> members(polygons);
  for (PolygonIndex p = 0; p < polygons; ++p) members[groups.root(p)].push_back(p);
  return members;
}

// The corners of the loop that is left of several polygons.
std::vector<std::uint32_t> corners_of(const Loops& loops, const std::vector<PolygonIndex>& members,
                                      const Scene& scene) {
  for (const PolygonIndex p : members) {
    for (Slot k = 0; k < scene.polygons[p].corners.size(); ++k) {
      const Slot begin = loops.first[p] + k;
      if (loops.next[begin] == no_slot) continue;
      std::vector<std::uint32_t> corners;
      for (Slot slot = begin; corners.empty() || slot != begin; slot = loops.next[slot]) {
        corners.push_back(loops.vertex[slot]);
        if (corners.size() > most_joined_corners) return {};
      }
      return corners;
    }
  }
  return {};
}

// The polygon that several become; nothing where they had better stay apart.
std::optional<Polygon> joined(const Scene& scene, const Loops& loops, const std::vector<PolygonIndex>& members,
                              double width) {
  const auto is_quadrilateral = [&scene](PolygonIndex p) { return scene.polygons[p].corners.size() == 4; };
  if (std::all_of(members.begin(), members.end(), is_quadrilateral)) return std::nullopt;
  Polygon whole = scene.polygons[members.front()];
  // Differences of neighbours add up.
  if (!std::all_of(members.begin(), members.end(),
                   [&](PolygonIndex p) { return continue_pictures(scene, whole, scene.polygons[p]); }))
    return std::nullopt;
  whole.corners = corners_of(loops, members, scene);
  if (whole.corners.empty()) return std::nullopt;
  double area = 0;
  for (const PolygonIndex p : members) area += area_vector(corner_points(scene, p)).norm();
  const Pieces pieces = pieces_of(scene, whole, width);
  if (pieces.defect || pieces.polygons.size() != 1) return std::nullopt;
  std::vector<Point> points;
  for (const std::uint32_t corner : whole.corners) points.push_back(scene.vertices[corner]);
  // What is turned over in part has less area than its faces.
  constexpr double rounding = 1e-6;
  if (std::abs(area_vector(points).norm() - area) > rounding * area) return std::nullopt;
  return whole;
}

bool goes_straight_on(const Point& before, const Point& at, const Point& after, double width) {
  const Vector in = at - before;
  const Vector out = after - at;
  if (in.dot(out) <= 0) return false;
  const double twice_the_area = in.cross(out).norm();
  return twice_the_area <= same_direction * in.norm() * out.norm() && twice_the_area <= width * (after - before).norm();
}

// Leaves out the corners of joined polygons at which every polygon goes straight on.
void leave_out_straight_corners(Scene& scene, const std::vector<std::uint8_t>& is_joined, double width) {
  enum : std::uint8_t { unused, straight, needed };
  std::vector<std::uint8_t> kind(scene.vertices.size(), unused);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<std::uint32_t>& corners = scene.polygons[p].corners;
    for (std::size_t k = 0, n = corners.size(); k < n; ++k) {
      const auto place = [&](std::size_t at) -> const Point& { return scene.vertices[corners[at % n]]; };
      if (n == 3 || !goes_straight_on(place(k + n - 1), place(k), place(k + 1), width))
        kind[corners[k]] = needed;
      else if (kind[corners[k]] == unused && is_joined[p] != 0)
        kind[corners[k]] = straight;
    }
  }
  for (Polygon& polygon : scene.polygons)
    std::erase_if(polygon.corners, [&kind](std::uint32_t corner) { return kind[corner] == straight; });
}

}  // namespace

Scene with_joined_faces(Scene scene) {
  // 1. Edges between faces that can become one, and the loops that are left without them.
  std::vector<Vector> normals(scene.polygons.size());
  for (PolygonIndex p = 0; p < normals.size(); ++p) normals[p] = front_normal(scene, p);
  Loops loops = loops_of(scene);
  find_mates(loops, scene, normals);
  if (std::all_of(loops.mate.begin(), loops.mate.end(), [](Slot mate) { return mate == no_slot; })) return scene;

  // 2. Each group of faces as one polygon, or as it is.
  const double width = weld_distance(scene);
  std::vector<std::uint8_t> is_joined;
  std::vector<Polygon> polygons;
  std::vector<std::optional<Polygon>> whole(scene.polygons.size());
  std::vector<std::uint8_t> is_part(scene.polygons.size(), 0);
  for (const std::vector<PolygonIndex>& members : joined_groups(loops, scene.polygons.size())) {
    if (members.size() < 2) continue;
    whole[members.front()] = joined(scene, loops, members, width);
    if (!whole[members.front()]) continue;
    for (const PolygonIndex p : members) is_part[p] = p != members.front();
  }
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_part[p] != 0) continue;
    is_joined.push_back(whole[p].has_value());
    polygons.push_back(whole[p] ? std::move(*whole[p]) : std::move(scene.polygons[p]));
  }
  scene.polygons = std::move(polygons);

  // 3. Corners that only the edges left out needed.
  leave_out_straight_corners(scene, is_joined, width);
  return scene;
}

}  // namespace patchlight
