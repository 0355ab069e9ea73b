#include "scene/holes.h"

#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/simple_polygon.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

// How far the unit normals of faces in one plane may differ; their means and farthest corners decide whether they share
// it.
constexpr double tilt_in_plane = 0.01;

// Pieces beside which a triangle is looked for in all, some 10 ns each, and in one plane.
constexpr std::size_t most_piece_tests = 10'000'000;
constexpr std::size_t most_pieces = 1000;
constexpr std::size_t vertices_of_a_test = 8;  // looked at in the same time

struct Piece {
  std::vector<Point> outline;
  Box box;
};

Piece piece_of(std::vector<Point> outline) {
  Piece piece{std::move(outline), {}};
  for (const Point& corner : piece.outline) piece.box.extend(corner);
  return piece;
}

// Counter-clockwise around the normal. Andrew 1979.
std::vector<Point> hull_around(std::vector<Point> points, const Vector& normal) {
  const Vector across = normal.unitOrthogonal();
  const Vector up = normal.cross(across);
  std::sort(points.begin(), points.end(), [&](const Point& a, const Point& b) {
    return std::pair(across.dot(a), up.dot(a)) < std::pair(across.dot(b), up.dot(b));
  });
  std::vector<Point> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t begin = hull.size();
    for (const Point& point : points) {
      while (hull.size() > begin + 1 &&
             normal.dot((hull.back() - *std::next(hull.rbegin())).cross(point - hull.back())) <= 0)
        hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// The faces of one plane, and what is left of their hull.
struct Plane {
  Vector normal;
  std::vector<Piece> pieces;

  std::size_t cut_out(const std::array<Point, 3>& triangle, double width);  // returns the pieces looked at
};

std::size_t Plane::cut_out(const std::array<Point, 3>& triangle, double width) {
  Box box;
  for (const Point& corner : triangle) box.extend(corner);
  const std::size_t tests = pieces.size();
  const auto touched =
      std::partition(pieces.begin(), pieces.end(), [&](const Piece& piece) { return !piece.box.intersects(box); });
  std::vector<std::vector<Point>> outlines;
  for (auto piece = touched; piece != pieces.end(); ++piece) outlines.push_back(std::move(piece->outline));
  pieces.erase(touched, pieces.end());
  for (std::vector<Point>& outline : beside(outlines, triangle, width)) pieces.push_back(piece_of(std::move(outline)));
  return tests;
}

std::vector<PolygonIndex> largest_first(const FaceTree& tree, std::size_t count) {
  std::vector<PolygonIndex> order(count);
  std::iota(order.begin(), order.end(), PolygonIndex{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](PolygonIndex a, PolygonIndex b) { return tree.face(a).area > tree.face(b).area; });
  return order;
}

FaceQuery plane_of(const FlatFace& face, const Box& everywhere, double near) {
  return {everywhere, std::numeric_limits<double>::infinity(), face.normal, tilt_in_plane, face.normal.dot(face.mean),
          near};
}

// Pieces that touch each other, one after the other.
std::vector<std::vector<Piece>> together(std::vector<Piece> pieces, double near) {
  const Vector margin = Vector::Constant(near);
  std::vector<std::vector<Piece>> holes;
  while (!pieces.empty()) {
    std::vector<Piece> hole{std::move(pieces.back())};
    pieces.pop_back();
    for (std::size_t k = 0; k < hole.size(); ++k) {
      const Box around(hole[k].box.min() - margin, hole[k].box.max() + margin);
      const auto touching = std::partition(pieces.begin(), pieces.end(),
                                           [&](const Piece& piece) { return !piece.box.intersects(around); });
      std::move(touching, pieces.end(), std::back_inserter(hole));
      pieces.erase(touching, pieces.end());
    }
    holes.push_back(std::move(hole));
  }
  return holes;
}

// How far around the faces of a plane corners of other faces that lie in it count, as a share of their extent: a wall
// may end a little below the ceiling, or lack a corner.
constexpr double margin_around_faces = 0.1;

struct HoleSearch {
  const Scene& scene;
  double width;           // metres; narrower pieces are left out
  std::size_t tests = 0;  // done so far, of pieces and of corners

  std::vector<Point> corners_in_plane(const std::vector<PolygonIndex>& faces, const Vector& normal);
  std::vector<Piece> left_free(const std::vector<PolygonIndex>& faces, const Vector& normal);
};

// Of these faces, and of others as near.
std::vector<Point> HoleSearch::corners_in_plane(const std::vector<PolygonIndex>& faces, const Vector& normal) {
  Box box;
  for (const PolygonIndex p : faces) {
    for (const std::uint32_t corner : scene.polygons[p].corners) box.extend(scene.vertices[corner]);
  }
  const Vector margin = Vector::Constant(margin_around_faces * box.diagonal().norm());
  const Box around(box.min() - margin, box.max() + margin);
  const double offset = normal.dot(scene.vertices[scene.polygons[faces[0]].corners[0]]);
  std::vector<Point> corners;
  for (const PolygonIndex p : faces) {
    for (const std::uint32_t corner : scene.polygons[p].corners) corners.push_back(scene.vertices[corner]);
  }
  for (const Point& vertex : scene.vertices) {
    if (std::abs(normal.dot(vertex) - offset) <= width && around.contains(vertex)) corners.push_back(vertex);
  }
  tests += scene.vertices.size() / vertices_of_a_test;
  return corners;
}

// What the hull of these corners holds beside the faces; nothing when that takes too many pieces.
std::vector<Piece> HoleSearch::left_free(const std::vector<PolygonIndex>& faces, const Vector& normal) {
  std::vector<Point> corners = corners_in_plane(faces, normal);
  Plane plane{normal, {piece_of(hull_around(std::move(corners), normal))}};
  for (const PolygonIndex p : faces) {
    for (const auto& triangle : triangles_of(corner_points(scene, p))) {
      tests += plane.cut_out(triangle, width);
      if (plane.pieces.size() > most_pieces || tests > most_piece_tests) return {};
    }
  }
  return std::move(plane.pieces);
}

}  // namespace

std::vector<Hole> holes_between_faces(const Scene& scene) {
  const FaceTree tree = tree_of_faces(scene);
  const Box everywhere = bounds(scene);
  const double near = weld_distance(scene);
  std::vector<std::uint8_t> seen(scene.polygons.size(), 0);
  std::vector<Hole> holes;
  HoleSearch search{scene, near};
  for (const PolygonIndex first : largest_first(tree, scene.polygons.size())) {
    if (seen[first] || !(tree.face(first).area > 0)) continue;
    std::vector<PolygonIndex> faces{first};
    seen[first] = 1;
    tree.for_each(plane_of(tree.face(first), everywhere, near), [&](std::size_t k) {
      if (seen[k]) return;
      seen[k] = 1;
      faces.push_back(static_cast<PolygonIndex>(k));
    });
    std::sort(faces.begin(), faces.end());
    for (std::vector<Piece>& pieces : together(search.left_free(faces, tree.face(first).normal), near)) {
      Hole hole{first, {}};
      for (Piece& piece : pieces) hole.pieces.push_back(std::move(piece.outline));
      holes.push_back(std::move(hole));
    }
    if (search.tests > most_piece_tests) break;
  }
  return holes;
}

}  // namespace patchlight
