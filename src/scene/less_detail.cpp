#include "scene/less_detail.h"

#include "base/disjoint_sets.h"
#include "base/tolerances.h"
#include "base/words.h"
#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/shells.h"
#include "scene/simple_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace patchlight {
namespace {

constexpr double same_direction = 1e-4;  // radians
using Slot = std::uint32_t;              // a corner of a polygon, and the edge that begins there
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

// True when one side of two polygons lies in the picture of its material as if both were one: to a hundredth of a texel
// of most pictures, and more than six digits of coordinates leave open.
bool continue_picture(const Scene& scene, const Polygon& a, const Polygon& b, Side side) {
  const TextureMap* one = texture_map_on(scene, a, side);
  const TextureMap* other = texture_map_on(scene, b, side);
  if (!one || !other) return one == other;
  for (const Polygon* polygon : {&a, &b}) {
    for (const std::uint32_t corner : polygon->corners) {
      const Point& at = scene.vertices[corner];
      if (!((one->linear * at + one->offset - other->linear * at - other->offset).norm() <= 1e-5)) return false;
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
        if (corners.size() > 2000) return {};
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
  // Differences of neighbors add up.
  if (!std::all_of(members.begin(), members.end(),
                   [&](PolygonIndex p) { return continue_pictures(scene, whole, scene.polygons[p]); }))
    return std::nullopt;
  whole.corners = corners_of(loops, members, scene);
  if (whole.corners.empty()) return std::nullopt;
  double area = 0;
  for (const PolygonIndex p : members) area += polygon_area(scene, p);
  const Pieces pieces = pieces_of(scene, whole, width);
  if (pieces.defect || pieces.polygons.size() != 1) return std::nullopt;
  // An outline that is turned over in part has less area than its faces.
  const double own_area = area_vector(corner_points(scene, whole.corners)).norm();
  if (std::abs(own_area - area) > tolerance_of_coordinates * area) return std::nullopt;
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

using Frame = Eigen::Matrix3d;  // its rows are the axes of a box

Box box_of(const Scene& scene, const std::vector<PolygonIndex>& shell, const Frame& frame) {
  Box box;
  for (const PolygonIndex p : shell) {
    for (const Point& corner : corner_points(scene, p)) box.extend(Point(frame * corner));
  }
  return box;
}

// Square to the largest face, and along that of its edges with which the box around the shell is least.
Frame frame_of(const Scene& scene, const std::vector<PolygonIndex>& shell) {
  const PolygonIndex largest = *std::max_element(shell.begin(), shell.end(), [&scene](PolygonIndex a, PolygonIndex b) {
    return polygon_area(scene, a) < polygon_area(scene, b);
  });
  const Vector normal = front_normal(scene, largest);
  const std::vector<Point> corners = corner_points(scene, largest);
  Frame best = Frame::Identity();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < std::min<std::size_t>(corners.size(), 8); ++k) {  // of a round face any will do
    const Vector edge = corners[(k + 1) % corners.size()] - corners[k];
    const Vector along = (edge - edge.dot(normal) * normal).normalized();
    Frame frame;
    frame.row(0) = along;
    frame.row(1) = normal.cross(along);
    frame.row(2) = normal;
    const double volume = box_of(scene, shell, frame).volume();
    if (volume < least) best = frame, least = volume;
  }
  return best;
}

// The corners of a box with these axes. Bits 0, 1 and 2 of a corner's number select its side along each axis.
std::array<Point, 8> box_corners(const Frame& frame, const Box& box) {
  std::array<Point, 8> corners;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Point place((corner & 1U) != 0 ? box.max().x() : box.min().x(),
                      (corner & 2U) != 0 ? box.max().y() : box.min().y(),
                      (corner & 4U) != 0 ? box.max().z() : box.min().z());
    corners[corner] = frame.transpose() * place;
  }
  return corners;
}

// Is every vertex within `detail` of the outside of the box?
bool is_near_box(const Scene& scene, const std::vector<PolygonIndex>& shell, const Frame& frame, const Box& box,
                 double detail) {
  for (const PolygonIndex p : shell) {
    for (const Point& corner : corner_points(scene, p)) {
      const Point place = frame * corner;
      if ((place - box.min()).cwiseMin(box.max() - place).minCoeff() > detail) return false;
    }
  }
  return true;
}

// Is the shell a body that is no room and has no hole through it? One with a hole, as a slab with a window or a frame,
// has another Euler characteristic than a ball's, V - E + F = 2.
bool is_solid_block(const Scene& scene, const std::vector<PolygonIndex>& shell, const Box& box, double width) {
  // One could stand inside where all sides are longer than 1 m.
  if (!(box.sizes().minCoeff() > width) || box.sizes().minCoeff() > 1) return false;
  std::set<std::uint32_t> vertices;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const PolygonIndex p : shell) {
    const std::vector<std::uint32_t>& corners = scene.polygons[p].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t next = corners[(k + 1) % corners.size()];
      vertices.insert(corners[k]);
      edges.emplace(std::min(corners[k], next), std::max(corners[k], next));
    }
  }
  return vertices.size() + shell.size() == edges.size() + 2;
}

// Does the shell, seen along each axis, fill the box but for a rim of width `detail`? Each line through a body meets
// two faces at least: half of the projected area is no less than that of its shadow.
bool fills_box(const Scene& scene, const std::vector<PolygonIndex>& shell, const Frame& frame, const Box& box,
               double detail) {
  Vector seen = Vector::Zero();
  for (const PolygonIndex p : shell) seen += (frame * area_vector(corner_points(scene, p))).cwiseAbs() / 2;
  const Vector sizes = box.sizes();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = sizes[(axis + 1) % 3];
    const double b = sizes[(axis + 2) % 3];
    const double without_rim = std::max(0.0, a - 2 * detail) * std::max(0.0, b - 2 * detail);
    // Far more is behind one another: shelves, a frame within a frame.
    if (seen[axis] < without_rim || (without_rim > 0 && seen[axis] > 1.5 * a * b)) return false;
  }
  return true;
}

// Has another shell a vertex deeper inside of the box than `detail`? Then it is a room, or a cupboard with something
// in.
bool holds_others(const Scene& scene, const FaceTree& tree, const Shells& shells, PolygonIndex shell,
                  const Frame& frame, const Box& box, double detail) {
  const Box within(box.min() + Vector::Constant(detail), box.max() - Vector::Constant(detail));
  if (within.isEmpty()) return false;
  Box around;
  for (const Point& corner : box_corners(frame, box)) around.extend(corner);
  bool holds = false;
  tree.for_each(FaceQuery{.box = around}, [&](std::size_t p) {
    if (holds || shells.shell[p] == shell) return;
    for (const Point& corner : corner_points(scene, static_cast<PolygonIndex>(p)))
      holds = holds || within.contains(Point(frame * corner));
  });
  return holds;
}

bool is_plain(const Scene& scene, PolygonIndex p) {
  return !is_lamp(scene, p) && !is_opening(scene, p) && !is_mirror(scene, p, Side::front) &&
         !is_mirror(scene, p, Side::back) && !is_sheet(scene, p);
}

// The faces' material, or a new one with their mean reflectance.
MaterialIndex material_of_box(Scene& scene, const std::vector<PolygonIndex>& shell) {
  const MaterialIndex first = scene.polygons[shell.front()].material;
  double area = 0;
  Spectrum reflected = Spectrum::Zero(scene.materials[first].reflectance.size());
  bool is_one = true;
  for (const PolygonIndex p : shell) {
    const MaterialIndex own = scene.polygons[p].material;
    is_one = is_one && own == first;
    area += polygon_area(scene, p);
    reflected += polygon_area(scene, p) * scene.materials[own].reflectance;
  }
  if (is_one) return first;
  Material mean = scene.materials[first];
  mean.name = "mean of " + group_name(scene, scene.polygons[shell.front()].group);
  mean.reflectance = reflected / area;
  mean.texture.reset();
  scene.materials.push_back(std::move(mean));
  return static_cast<MaterialIndex>(scene.materials.size() - 1);
}

// Six faces, with their fronts outside.
std::vector<Polygon> box_faces(Scene& scene, const std::vector<PolygonIndex>& shell, const Frame& frame,
                               const Box& box) {
  const auto begin = static_cast<std::uint32_t>(scene.vertices.size());
  for (const Point& corner : box_corners(frame, box)) scene.vertices.push_back(corner);
  constexpr std::array<std::array<std::uint32_t, 4>, 6> sides = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  Polygon face = scene.polygons[shell.front()];
  face.material = material_of_box(scene, shell);
  face.back_material.reset();
  face.texture_map = no_texture_map;
  std::vector<Polygon> faces;
  for (const auto& side : sides) {
    face.corners.clear();
    for (const std::uint32_t corner : side) face.corners.push_back(begin + corner);
    faces.push_back(face);
  }
  return faces;
}

std::string share(double part, double all) { return rounded(100 * part / all, 2) + " % of the area"; }

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

Scene with_less_detail(Scene scene, double detail) {
  std::map<PolygonIndex, std::vector<PolygonIndex>> shells;
  const Shells found = shells_of(scene);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) shells[found.shell[p]].push_back(p);

  const double width = weld_distance(scene);
  const FaceTree tree = tree_of_faces(scene, FaceOrder::by_place);
  std::vector<Polygon> polygons;
  std::size_t left_out = 0, boxes = 0;
  double area = 0, area_left_out = 0, area_of_boxes = 0;
  for (const auto& [first, shell] : shells) {
    double own = 0;
    for (const PolygonIndex p : shell) own += polygon_area(scene, p);
    area += own;
    const bool plain = std::all_of(shell.begin(), shell.end(), [&scene](PolygonIndex p) { return is_plain(scene, p); });
    const Frame frame = frame_of(scene, shell);
    const Box box = box_of(scene, shell, frame);
    if (plain && box.sizes().maxCoeff() < detail) {
      ++left_out;
      area_left_out += own;
    } else if (plain && found.closed[first] != 0 && shell.size() > 6 && is_solid_block(scene, shell, box, width) &&
               is_near_box(scene, shell, frame, box, detail) && fills_box(scene, shell, frame, box, detail) &&
               !holds_others(scene, tree, found, first, frame, box, detail)) {
      ++boxes;
      area_of_boxes += own;
      for (Polygon& face : box_faces(scene, shell, frame, box)) polygons.push_back(std::move(face));
    } else {
      for (const PolygonIndex p : shell) polygons.push_back(scene.polygons[p]);
    }
  }
  if (left_out + boxes == 0 || polygons.empty()) return scene;
  scene.diagnostics.push_back(
      {DiagnosticCode::reduced_model, "detail below " + rounded(100 * detail, 3) + " cm: " + std::to_string(left_out) +
                                          (left_out == 1 ? " body, " : " bodies, ") + share(area_left_out, area) +
                                          ", left out; " + std::to_string(boxes) +
                                          (boxes == 1 ? " body, " : " bodies, ") + share(area_of_boxes, area) +
                                          ", taken as boxes; " + std::to_string(scene.polygons.size()) + " faces are " +
                                          std::to_string(polygons.size())});
  scene.polygons = std::move(polygons);
  return scene;
}

}  // namespace patchlight
