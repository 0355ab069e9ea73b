#include "scene/less_detail.h"

#include "base/rounded.h"
#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/shells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace patchlight {
namespace {

using Frame = Eigen::Matrix3d;  // its rows are the axes of a box

double area_of(const Scene& scene, PolygonIndex p) { return area_vector(corner_points(scene, p)).norm(); }

Box box_of(const Scene& scene, const std::vector<PolygonIndex>& shell, const Frame& frame) {
  Box box;
  for (const PolygonIndex p : shell) {
    for (const Point& corner : corner_points(scene, p)) box.extend(Point(frame * corner));
  }
  return box;
}

// Square to the largest face, and along that of its edges with which the box around the shell is least.
Frame frame_of(const Scene& scene, const std::vector<PolygonIndex>& shell) {
  constexpr std::size_t most_edges = 8;  // of a round face any will do
  const PolygonIndex largest = *std::max_element(shell.begin(), shell.end(), [&scene](PolygonIndex a, PolygonIndex b) {
    return area_of(scene, a) < area_of(scene, b);
  });
  const Vector normal = front_normal(scene, largest);
  const std::vector<Point> corners = corner_points(scene, largest);
  Frame best = Frame::Identity();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < std::min(corners.size(), most_edges); ++k) {
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

// The corners of a box with these axes; bit 0, 1 and 2 of their number tell on which side each is.
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
  constexpr double depth_of_rooms = 1;  // metres: where all sides are longer one could stand inside
  if (!(box.sizes().minCoeff() > width) || box.sizes().minCoeff() > depth_of_rooms) return false;
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
    const double most = 1.5 * a * b;  // far more is behind one another: shelves, a frame within a frame
    if (seen[axis] < without_rim || (without_rim > 0 && seen[axis] > most)) return false;
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
  constexpr double any = std::numeric_limits<double>::infinity();
  bool holds = false;
  tree.for_each(FaceQuery{around, any, Vector::UnitZ(), any, 0, any}, [&](std::size_t p) {
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
    area += area_of(scene, p);
    reflected += area_of(scene, p) * scene.materials[own].reflectance;
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
    for (const PolygonIndex p : shell) own += area_of(scene, p);
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
