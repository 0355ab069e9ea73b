#include "scene/coverings.h"

#include "base/parallel.h"
#include "base/tolerances.h"
#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/model_face.h"
#include "scene/simple_polygon.h"
#include "scene/solids.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

constexpr double parallel = 0.999;

// Areas that differ by less than this factor count as equal.
constexpr double same_area = 1 + tolerance_of_shapes;

// The triangles of polygons with many corners. Many panes in one wall ask for those of the wall.
std::vector<std::vector<Triangle>> triangles_of_large(const Scene& scene) {
  std::vector<std::vector<Triangle>> triangles(scene.polygons.size());
  parallel_for(triangles.size(), [&](std::size_t p) {
    if (scene.polygons[p].corners.size() > 8)
      triangles[p] = triangles_of(corner_points(scene, static_cast<PolygonIndex>(p)));
  });
  return triangles;
}

bool is_kept(const KeptSides& kept, PolygonIndex polygon, Side side) {
  return (side == Side::front ? kept.front : kept.back)[polygon] != 0;
}

// Over which side of which polygon another lies, and by which side of its own.
struct Covered {
  PolygonIndex polygon = 0;
  Side side = Side::front;
  PolygonIndex by = 0;
  Side by_side = Side::front;
};

// Finds the polygons that lie over one, side by side.
struct Search {
  const Scene& scene;
  const KeptSides& kept;
  FaceTree tree;
  double slack;  // meters
  std::vector<std::vector<Triangle>> known_triangles = triangles_of_large(scene);

  // Admits all that may lie over it, in its plane with a margin for rounding: of a pane larger ones as well.
  FaceQuery query_over(PolygonIndex polygon) const {
    const FlatFace& lower = tree.face(polygon);
    const double farthest = lower.box.min().cwiseAbs().cwiseMax(lower.box.max().cwiseAbs()).norm();
    return {with_margin(lower.box, slack),
            is_opening(scene, polygon) ? FaceQuery::any : same_area * lower.area,
            lower.normal,
            std::sqrt(2 - 2 * parallel) + tolerance_of_arithmetic,
            lower.normal.dot(scene.vertices[scene.polygons[polygon].corners[0]]),
            slack + tolerance_of_arithmetic * farthest};
  }

  // The corners of the smaller one are measured over the plane of the larger one.
  bool in_one_plane(PolygonIndex smaller, PolygonIndex larger) const {
    const Vector& normal = tree.face(larger).normal;
    const Point& on_plane = scene.vertices[scene.polygons[larger].corners[0]];
    const std::vector<Point> corners = corner_points(scene, smaller);
    return std::abs(tree.face(smaller).normal.dot(normal)) >= parallel &&
           std::all_of(corners.begin(), corners.end(),
                       [&](const Point& corner) { return std::abs(normal.dot(corner - on_plane)) <= slack; });
  }

  std::vector<Triangle> triangles(PolygonIndex polygon) const {
    return known_triangles[polygon].empty() ? triangles_of(corner_points(scene, polygon)) : known_triangles[polygon];
  }

  // The polygons over one; but opaque ones that cover a clear one together, or with larger ones, to a hundredth of it,
  // are the wall on which that is drawn, in pieces: the clear one lies over each of these.
  std::vector<Covered> of(PolygonIndex polygon) const {
    std::vector<Covered> over;
    std::vector<Covered> under;
    double pieces = 0;  // the area that smaller opaque ones take of a pane
    double larger = 0;  // and larger ones, over which it lies
    const FlatFace& lower = tree.face(polygon);
    std::vector<Triangle> own;  // once they are needed
    const auto overlap_with = [&](PolygonIndex upper, double enough) {
      if (own.empty()) own = triangles(polygon);
      if (!known_triangles[upper].empty()) return common_area(own, known_triangles[upper], lower.normal, enough);
      return common_area(own, triangles(upper), lower.normal, enough);
    };
    const bool is_pane = is_opening(scene, polygon);
    tree.for_each(query_over(polygon), [&](PolygonIndex upper) {
      if (upper == polygon) return;
      if (!comes_first(upper, polygon)) {
        if (is_pane && !is_opening(scene, upper) && in_one_plane(polygon, upper))
          larger += overlap_with(upper, lower.area);
        return;
      }
      if (!in_one_plane(upper, polygon)) return;
      const bool may_be_wall = is_pane && !is_opening(scene, upper);
      // Smaller overlaps are rounding at a common edge.
      const double least = tolerance_of_coordinates * std::min(lower.area, tree.face(upper).area);
      const double area = overlap_with(upper, may_be_wall ? lower.area : least);
      if (area <= least) return;
      if (may_be_wall) pieces += area;
      const bool same_front = lower.normal.dot(area_vector(corner_points(scene, upper))) > 0;
      for (const Side side : {Side::front, Side::back}) {
        const Side other_side = (side == Side::front) == same_front ? Side::front : Side::back;
        if (!is_kept(kept, polygon, side) || !is_kept(kept, upper, other_side)) continue;
        over.push_back({polygon, side, upper, other_side});
        if (may_be_wall) under.push_back({upper, other_side, polygon, side});
      }
    });
    const double wall = 0.99 * lower.area;
    if (larger >= wall || larger + pieces < wall) return over;
    for (const Covered& covered : over) {
      if (is_opening(scene, covered.by)) under.push_back(covered);
    }
    return under;
  }

  // Does `a` lie over `b`? A strict order: of two polygons exactly one lies over the other.
  bool comes_first(PolygonIndex a, PolygonIndex b) const {
    if (tree.face(a).area > same_area * tree.face(b).area) return false;
    if (tree.face(b).area > same_area * tree.face(a).area) return true;
    return a < b;
  }
};

// Is the larger face seen from both sides, and the smaller one opaque and without light?
bool may_hide(const Scene& scene, const KeptSides& kept, const Covered& covered) {
  return kept.front[covered.polygon] != 0 && kept.back[covered.polygon] != 0 && !is_opening(scene, covered.polygon) &&
         !is_opening(scene, covered.by) && !emits(scene, covered.by, covered.by_side);
}

// Where the smaller face is one of a closed solid, as the edge of a desk against a wall without thickness, the larger
// one lies over it. But a face over a lamp stays in sight with that, or each of the three would lie under another.
// Solids are looked for where that may be.
void hide_solids(const Scene& scene, const KeptSides& kept, std::vector<Covered>& found) {
  std::vector<std::uint8_t> lies_over_lamp(scene.polygons.size(), 0);
  for (const Covered& covered : found) {
    if (emits(scene, covered.polygon, covered.side)) lies_over_lamp[covered.by] = 1;
  }
  std::vector<Covered*> pairs;
  for (Covered& covered : found) {
    if (lies_over_lamp[covered.by] == 0 && may_hide(scene, kept, covered)) pairs.push_back(&covered);
  }
  if (pairs.empty()) return;
  const std::shared_ptr<const SceneGeometry> geometry = geometry_of(scene, kept);
  for (Covered* const pair : pairs) {
    const Side behind = pair->by_side == Side::front ? Side::back : Side::front;
    const bool is_of_solid = geometry->inner[2 * std::size_t{pair->by} + static_cast<std::size_t>(behind)] != 0;
    if (is_of_solid) *pair = {pair->by, pair->by_side, pair->polygon, pair->side};
  }
}

// Tests of a triangle against a piece in all, about 10 ns each.
constexpr std::size_t most_piece_tests = 10'000'000;

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

// The faces of one plane, and the rest of their hull.
struct Plane {
  Vector normal;
  std::vector<Piece> pieces;

  // Returns the number of pieces tested.
  std::size_t cut_out(const Triangle& triangle, double width) {
    Box box;
    for (const Point& corner : triangle) box.extend(corner);
    const std::size_t tests = pieces.size();
    const auto touched =
        std::partition(pieces.begin(), pieces.end(), [&](const Piece& piece) { return !piece.box.intersects(box); });
    std::vector<std::vector<Point>> outlines;
    for (auto piece = touched; piece != pieces.end(); ++piece) outlines.push_back(std::move(piece->outline));
    pieces.erase(touched, pieces.end());
    for (std::vector<Point>& outline : beside(outlines, triangle, width))
      pieces.push_back(piece_of(std::move(outline)));
    return tests;
  }
};

std::vector<PolygonIndex> largest_first(const FaceTree& tree, std::size_t count) {
  std::vector<PolygonIndex> order(count);
  std::iota(order.begin(), order.end(), PolygonIndex{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](PolygonIndex a, PolygonIndex b) { return tree.face(a).area > tree.face(b).area; });
  return order;
}

FaceQuery plane_of(const FlatFace& face, const Box& everywhere, double near) {
  // Means and farthest corners decide whether faces share a plane.
  return {
      .box = everywhere, .normal = face.normal, .tilt = 0.01, .offset = face.normal.dot(face.mean), .tolerance = near};
}

// Pieces that touch each other, one after the other.
std::vector<std::vector<Piece>> together(std::vector<Piece> pieces, double near) {
  std::vector<std::vector<Piece>> holes;
  while (!pieces.empty()) {
    std::vector<Piece> hole{std::move(pieces.back())};
    pieces.pop_back();
    for (std::size_t k = 0; k < hole.size(); ++k) {
      const Box around = with_margin(hole[k].box, near);
      const auto touching = std::partition(pieces.begin(), pieces.end(),
                                           [&](const Piece& piece) { return !piece.box.intersects(around); });
      std::move(touching, pieces.end(), std::back_inserter(hole));
      pieces.erase(touching, pieces.end());
    }
    holes.push_back(std::move(hole));
  }
  return holes;
}

struct HoleSearch {
  const Scene& scene;
  double width;           // meters; narrower pieces are left out
  std::size_t tests = 0;  // done so far, of pieces and of corners

  // The corners of these faces, and those of other faces near them in their plane.
  std::vector<Point> corners_in_plane(const std::vector<PolygonIndex>& faces, const Vector& normal) {
    Box box;
    std::vector<Point> corners;
    for (const PolygonIndex p : faces) {
      box.extend(polygon_box(scene, p));
      const std::vector<Point> own = corner_points(scene, p);
      corners.insert(corners.end(), own.begin(), own.end());
    }
    // A wall may end a little below the ceiling, or lack a corner.
    const Box around = with_margin(box, 0.1 * box.diagonal().norm());
    const double offset = normal.dot(scene.vertices[scene.polygons[faces[0]].corners[0]]);
    for (const Point& vertex : scene.vertices) {
      if (std::abs(normal.dot(vertex) - offset) <= width && around.contains(vertex)) corners.push_back(vertex);
    }
    tests += scene.vertices.size() / 8;  // a test has the cost of 8 vertices
    return corners;
  }

  // The parts of the hull of these corners beside the faces; nothing when there are too many pieces.
  std::vector<Piece> left_free(const std::vector<PolygonIndex>& faces, const Vector& normal) {
    std::vector<Point> corners = corners_in_plane(faces, normal);
    Plane plane{normal, {piece_of(hull_around(std::move(corners), normal))}};
    for (const PolygonIndex p : faces) {
      for (const auto& triangle : triangles_of(corner_points(scene, p))) {
        tests += plane.cut_out(triangle, width);
        if (plane.pieces.size() > 1000 || tests > most_piece_tests) return {};
      }
    }
    return std::move(plane.pieces);
  }
};

}  // namespace

bool Coverings::lies_over(PolygonIndex upper, PolygonIndex polygon, Side side) const {
  const auto over_it = over_side(polygon, side);
  return std::binary_search(over_it.begin(), over_it.end(), upper);
}

Coverings find_coverings(const Scene& scene, const KeptSides& kept) {
  const std::size_t count = scene.polygons.size();
  std::vector<FlatFace> faces(count);
  parallel_for(count, [&](std::size_t p) { faces[p] = flat_face(corner_points(scene, static_cast<PolygonIndex>(p))); });
  const Search search{scene, kept, FaceTree(std::move(faces), FaceOrder::by_place),
                      in_plane_tolerance * extent_of(scene)};
  std::vector<std::vector<Covered>> found(count);
  parallel_for(count, [&](std::size_t p) { found[p] = search.of(static_cast<PolygonIndex>(p)); });
  std::vector<Covered> all;
  for (const std::vector<Covered>& some : found) all.insert(all.end(), some.begin(), some.end());
  hide_solids(scene, kept, all);
  std::vector<std::vector<PolygonIndex>> over(2 * count);
  for (const Covered& covered : all)
    over[2 * std::size_t{covered.polygon} + static_cast<std::size_t>(covered.side)].push_back(covered.by);
  parallel_for(over.size(), [&](std::size_t side) { std::sort(over[side].begin(), over[side].end()); });
  const bool none = std::all_of(over.begin(), over.end(), [](const auto& side) { return side.empty(); });
  return none ? Coverings{} : Coverings{std::move(over)};
}

namespace {

// The faces under others.
struct CoveredFaces {
  std::vector<ModelFace> faces;      // under smaller ones, or equal ones
  std::vector<ModelFace> of_solids;  // under larger ones
  std::vector<ModelFace> lamps;      // those of them that emit
};

CoveredFaces covered_faces(const Scene& scene, const Coverings& coverings) {
  CoveredFaces covered;
  for (PolygonIndex p = 0; 2 * std::size_t{p} < coverings.over.size(); ++p) {
    bool is_covered = false;
    bool is_hidden = false;
    bool is_dark_lamp = false;
    for (const Side side : {Side::front, Side::back}) {
      const auto over = coverings.over_side(p, side);
      if (over.empty()) continue;
      const double area = same_area * polygon_area(scene, p);
      // But a pane lies over the smaller pieces of a wall.
      const auto is_larger = [&](PolygonIndex other) {
        return !is_opening(scene, other) && polygon_area(scene, other) > area;
      };
      (std::any_of(over.begin(), over.end(), is_larger) ? is_hidden : is_covered) = true;
      is_dark_lamp = is_dark_lamp || emits(scene, p, side);
    }
    if (!is_covered && !is_hidden) continue;
    const ModelFace face = model_face(scene, scene.polygons[p]);
    if (is_covered) covered.faces.push_back(face);
    if (is_hidden) covered.of_solids.push_back(face);
    if (is_dark_lamp) covered.lamps.push_back(face);
  }
  return covered;
}

}  // namespace

Diagnostics problems_with_overlaps(const Scene& scene, const Coverings& coverings) {
  auto [faces, of_solids, lamps] = covered_faces(scene, coverings);
  Diagnostics problems;
  const auto add = [&](DiagnosticCode code, std::vector<ModelFace> concerned, const std::string& what) {
    if (concerned.empty()) return;
    const std::size_t count = concerned.size();
    const std::string text = listed(scene, concerned) + (count == 1 ? " lies" : " lie") + what;
    problems.push_back({code, text, count, std::move(concerned)});
  };
  add(DiagnosticCode::covered_lamp, std::move(lamps),
      " in part under a smaller one in the same plane, or an equal one before it, and no light comes from there");
  add(DiagnosticCode::overlapping_faces, std::move(faces),
      " in part under another in the same plane; where they overlap, the smaller one is visible, or the first of equal "
      "ones. Error bars do not include the effect of this choice");
  add(DiagnosticCode::overlapping_faces, std::move(of_solids),
      " against a larger one that is visible from both sides, with a solid behind it. patchlight hides the solid from "
      "the other side. If the solid is recessed into the larger face, cut the face out there");
  return problems;
}

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
