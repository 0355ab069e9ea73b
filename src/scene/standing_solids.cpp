#include "scene/standing_solids.h"

#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/simple_polygon.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t most_rim_corners = 1000;
constexpr std::size_t most_lid_triangles = 1000;
constexpr std::size_t most_corners_in_planes = 64;

// How far the unit normals of a rim and of a face under it may differ; corners decide whether they share a plane.
constexpr double largest_tilt = 0.05;

using Triangle = std::array<Point, 3>;

// The rims of one shell as outlines of what would close it, which walk along each edge against its polygon. Nothing
// where rims meet in a vertex.
std::optional<std::vector<std::vector<Point>>> outlines_of(const Scene& scene, const std::vector<RimEdge>& edges) {
  std::map<std::uint32_t, std::uint32_t> before;
  for (const RimEdge& edge : edges) {
    if (!before.emplace(edge.to, edge.from).second) return std::nullopt;
  }
  std::vector<std::vector<Point>> outlines;
  while (!before.empty()) {
    std::vector<Point> outline;
    for (auto at = before.begin(); at != before.end();) {
      outline.push_back(scene.vertices[at->first]);
      const std::uint32_t next = at->second;
      before.erase(at);
      at = before.find(next);
    }
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

// Looks for the faces under rims.
struct FacesUnderRims {
  const Scene& scene;
  const Shells& shells;
  FaceTree tree;
  double near;    // metres
  double extent;  // metres, of the scene

  bool is_closed(const std::vector<Point>& outline, PolygonIndex shell) const;
  bool shares_plane(PolygonIndex polygon, const std::vector<Point>& outline) const;
  bool can_close(const std::vector<Point>& outline, PolygonIndex shell) const;
  std::optional<std::vector<Point>> closed_run(const std::vector<Point>& outline, std::size_t first,
                                               PolygonIndex shell) const;
  std::optional<std::vector<Triangle>> lids_over(std::vector<Point> outline, PolygonIndex shell) const;
  std::optional<std::vector<Triangle>> lids(const std::vector<RimEdge>& edges) const;
};

bool FacesUnderRims::shares_plane(PolygonIndex polygon, const std::vector<Point>& outline) const {
  const Vector& normal = tree.face(polygon).normal;
  const Point& on_plane = scene.vertices[scene.polygons[polygon].corners[0]];
  return std::all_of(outline.begin(), outline.end(),
                     [&](const Point& corner) { return std::abs(normal.dot(corner - on_plane)) <= near; });
}

// Do opaque faces of other shells fill the outline? What is left of it beside them is then narrower than `near`.
bool FacesUnderRims::is_closed(const std::vector<Point>& outline, PolygonIndex shell) const {
  FlatFace rim = flat_face(outline);
  const Vector margin = Vector::Constant(near);
  const FaceQuery query{Box(rim.box.min() - margin, rim.box.max() + margin),
                        std::numeric_limits<double>::infinity(),
                        rim.normal,
                        largest_tilt,
                        rim.normal.dot(outline[0]),
                        extent};
  std::vector<std::vector<Point>> left;
  for (const Triangle& triangle : triangles_of(outline)) left.emplace_back(triangle.begin(), triangle.end());
  std::size_t triangles = 0;
  tree.for_each(query, [&](PolygonIndex p) {
    if (shells.shell[p] == shell || left.empty() || triangles > most_lid_triangles) return;
    if (is_opening(scene, p) || is_sheet(scene, p) || !shares_plane(p, outline)) return;
    for (const Triangle& triangle : triangles_of(corner_points(scene, p))) {
      if (++triangles <= most_lid_triangles) left = beside(left, triangle, near);
    }
  });
  return left.empty();
}

bool FacesUnderRims::can_close(const std::vector<Point>& outline, PolygonIndex shell) const {
  return outline.size() >= 3 && !is_narrow(outline, near) && !crosses_itself(outline) && is_closed(outline, shell);
}

// The corners from `first` on, as many as lie in one plane, when faces fill the polygon that they are.
std::optional<std::vector<Point>> FacesUnderRims::closed_run(const std::vector<Point>& outline, std::size_t first,
                                                             PolygonIndex shell) const {
  std::vector<Point> run;
  Vector normal = Vector::Zero();
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& corner = outline[(first + k) % outline.size()];
    const bool has_plane = run.size() >= 3 && !is_narrow(run, near);
    if (has_plane && normal.isZero(0)) normal = plane_normal(run);
    if (has_plane && std::abs(normal.dot(corner - run.front())) > near) break;
    run.push_back(corner);
  }
  if (!can_close(run, shell)) return std::nullopt;
  return run;
}

// Of an outline that lies in several planes, as that of a wall with a door, which ends at floor, ceiling and walls,
// runs of corners that faces fill are cut off one after the other.
std::optional<std::vector<Triangle>> FacesUnderRims::lids_over(std::vector<Point> outline, PolygonIndex shell) const {
  std::vector<Triangle> lids;
  const auto add = [&](const std::vector<Point>& lid) {
    const std::vector<Triangle> triangles = triangles_of(lid);
    lids.insert(lids.end(), triangles.begin(), triangles.end());
  };
  while (!can_close(outline, shell)) {
    if (outline.size() > most_corners_in_planes) return std::nullopt;
    std::vector<Point> longest;
    std::size_t begin = 0;
    for (std::size_t first = 0; first < outline.size(); ++first) {
      std::optional<std::vector<Point>> run = closed_run(outline, first, shell);
      if (!run || run->size() <= longest.size() || run->size() >= outline.size()) continue;
      longest = std::move(*run);
      begin = first;
    }
    if (longest.empty()) return std::nullopt;
    add(longest);
    // Its first and its last corner stay.
    std::rotate(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(begin), outline.end());
    outline.erase(outline.begin() + 1, outline.begin() + static_cast<std::ptrdiff_t>(longest.size()) - 1);
  }
  add(outline);
  return lids;
}

// Triangles over all rims of a shell; nothing when one of them stays open.
std::optional<std::vector<Triangle>> FacesUnderRims::lids(const std::vector<RimEdge>& edges) const {
  if (edges.size() > most_rim_corners) return std::nullopt;
  const auto outlines = outlines_of(scene, edges);
  if (!outlines) return std::nullopt;
  std::vector<Triangle> lids;
  for (const std::vector<Point>& outline : *outlines) {
    const auto over = lids_over(outline, shells.shell[edges.front().polygon]);
    if (!over) return std::nullopt;
    lids.insert(lids.end(), over->begin(), over->end());
  }
  return lids;
}

// Do all these polygons lie in one plane? Then nothing closes them to a solid.
bool are_flat(const Scene& scene, const std::vector<PolygonIndex>& polygons, double near) {
  const Vector normal = front_normal(scene, polygons.front());
  const Point& on_plane = scene.vertices[scene.polygons[polygons.front()].corners[0]];
  const auto in_plane = [&](std::uint32_t corner) {
    return std::abs(normal.dot(scene.vertices[corner] - on_plane)) <= near;
  };
  return std::all_of(polygons.begin(), polygons.end(), [&](PolygonIndex p) {
    return std::all_of(scene.polygons[p].corners.begin(), scene.polygons[p].corners.end(), in_plane);
  });
}

}  // namespace

std::vector<Solid> standing_solids(const Scene& scene, const Shells& shells) {
  std::map<PolygonIndex, std::vector<RimEdge>> rims;  // by shell
  for (const RimEdge& edge : shells.rim) {
    if (shells.rimmed[edge.polygon]) rims[shells.shell[edge.polygon]].push_back(edge);
  }
  if (rims.empty()) return {};
  std::map<PolygonIndex, std::vector<PolygonIndex>> members;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (shells.rimmed[p]) members[shells.shell[p]].push_back(p);
  }
  const FacesUnderRims search{scene, shells, tree_of_faces(scene), weld_distance(scene), extent_of(scene)};
  std::vector<Solid> solids;
  for (const auto& [shell, edges] : rims) {
    if (are_flat(scene, members[shell], search.near)) continue;
    std::optional<std::vector<Triangle>> lids = search.lids(edges);
    if (!lids) continue;
    std::optional<Solid> solid = solid_of(scene, std::move(members[shell]), shells, std::move(*lids));
    if (solid) solids.push_back(std::move(*solid));
  }
  return solids;
}

}  // namespace patchlight
