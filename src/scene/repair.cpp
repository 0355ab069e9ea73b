#include "scene/repair.h"

#include "scene/extent.h"
#include "scene/model_face.h"
#include "scene/openings.h"
#include "scene/shells.h"
#include "scene/simple_polygon.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace patchlight {
namespace {

// Polygons with the same corners in the same or the opposite order.
struct Coincidence {
  struct Pair {
    PolygonIndex first, second;  // the first polygon at a place, and another one there
    bool same_front;
  };
  std::vector<Pair> pairs;              // by `second`
  std::vector<std::uint8_t> is_second;  // per polygon
};

using Loop = std::vector<std::uint32_t>;

// A polygon's corners in an order that does not depend on where its outline begins and which way it goes.
struct Key {
  Loop loop;
  bool reversed = false;
};

// The rotation that comes first.
Loop first_rotation(const Loop& loop) {
  const std::uint32_t least = *std::min_element(loop.begin(), loop.end());
  Loop best;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    if (loop[k] != least) continue;
    Loop rotated(loop.begin() + static_cast<std::ptrdiff_t>(k), loop.end());
    rotated.insert(rotated.end(), loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(k));
    if (best.empty() || rotated < best) best = std::move(rotated);
  }
  return best;
}

Key key_of(const Loop& corners) {
  Loop forward = first_rotation(corners);
  Loop backward = first_rotation(Loop(corners.rbegin(), corners.rend()));
  if (backward < forward) return {std::move(backward), true};
  return {std::move(forward), false};
}

// Compares the indices of corners: vertices have to be welded.
Coincidence find_coincident(const Scene& scene) {
  std::vector<Key> keys;
  keys.reserve(scene.polygons.size());
  for (const Polygon& polygon : scene.polygons) keys.push_back(key_of(polygon.corners));
  std::vector<PolygonIndex> order(keys.size());
  std::iota(order.begin(), order.end(), PolygonIndex{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](PolygonIndex a, PolygonIndex b) { return keys[a].loop < keys[b].loop; });

  Coincidence found{{}, std::vector<std::uint8_t>(keys.size(), 0)};
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && keys[order[end]].loop == keys[order[begin]].loop) ++end;
    for (std::size_t k = begin + 1; k < end; ++k) {
      found.pairs.push_back({order[begin], order[k], keys[order[begin]].reversed == keys[order[k]].reversed});
      found.is_second[order[k]] = 1;
    }
  }
  std::sort(found.pairs.begin(), found.pairs.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return found;
}

using Faces = std::vector<ModelFace>;

// The scene with one more problem, unless no face is concerned. `does` follows the number of faces: "have no area".
Scene with_problem(Scene scene, DiagnosticCode code, Faces faces, const std::string& does) {
  if (faces.empty()) return scene;
  const std::string text = listed(scene, faces) + " " + does;
  const double area = area_of(faces);
  scene.diagnostics.push_back({code, text, faces.size(), std::move(faces), area});
  return scene;
}

Scene number_faces(Scene scene) {
  scene.faces = scene.polygons.size();
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) scene.polygons[p].face = p;
  return scene;
}

// A stray vertex shall not decide how large details are.
Scene report_far_faces(Scene scene) {
  Faces far;
  const Box main = main_bounds(scene);
  double farthest = 0;
  for (const PolygonIndex p : far_polygons(scene)) {
    far.push_back(model_face(scene, scene.polygons[p]));
    for (const Point& corner : far.back().corners) farthest = std::max(farthest, main.exteriorDistance(corner));
  }
  std::ostringstream does;
  does.precision(3);
  does << "up to " << farthest << " m from the rest of the model (" << main.sizes().maxCoeff()
       << " m long). Tolerances follow the main part\nhint: delete the stray faces";
  return with_problem(std::move(scene), DiagnosticCode::implausible_size, std::move(far), does.str());
}

// Keeps one vertex of those at one place, and only those that polygons use.
Scene weld_vertices(Scene scene) {
  const std::vector<std::uint32_t> used_numbers = used_vertices(scene);
  const std::vector<Point> used = corner_points(scene, used_numbers);
  const double distance = weld_distance(scene);
  const std::vector<std::uint32_t> stands_for = welded(used, distance);

  std::size_t moved = 0;
  std::vector<std::uint32_t> new_number(scene.vertices.size());
  scene.vertices.clear();
  for (std::size_t k = 0; k < used.size(); ++k) {
    const std::uint32_t first = stands_for[k];
    new_number[used_numbers[k]] =
        first == k ? static_cast<std::uint32_t>(scene.vertices.size()) : new_number[used_numbers[first]];
    if (first == k) scene.vertices.push_back(used[k]);
    moved += used[k] != used[first];
  }
  for (Polygon& polygon : scene.polygons) {
    for (std::uint32_t& corner : polygon.corners) corner = new_number[corner];
  }
  if (moved == 0) return scene;
  std::ostringstream what;
  what << (moved == 1 ? "1 vertex is" : std::to_string(moved) + " vertices are") << " within " << distance
       << " m of another one: each pair is taken as one vertex";
  scene.diagnostics.push_back({DiagnosticCode::welded_vertices, what.str(), moved});
  return scene;
}

// Does the outline turn back at b, so that from a to c it is a spike narrower than `width`?
bool is_spike(const Point& a, const Point& b, const Point& c, double width) {
  const Vector back = a - b;
  const Vector on = c - b;
  if (back.dot(on) <= 0) return false;
  const Vector& longer = back.squaredNorm() > on.squaredNorm() ? back : on;
  const Vector& shorter = back.squaredNorm() > on.squaredNorm() ? on : back;
  return shorter.cross(longer.normalized()).norm() <= width;
}

// The corners without those that repeat the one before, and without the tips of spikes.
std::vector<std::uint32_t> without_spikes(std::vector<std::uint32_t> corners, const std::vector<Point>& vertices,
                                          double width) {
  const auto signed_place = [](std::size_t place) { return static_cast<std::ptrdiff_t>(place); };
  for (std::size_t k = 0, sound = 0; corners.size() > 1 && sound < corners.size();) {
    const std::size_t n = corners.size();
    const std::uint32_t before = corners[(k + n - 1) % n];
    const std::uint32_t after = corners[(k + 1) % n];
    const bool leave_out = before == corners[k] || before == after ||
                           is_spike(vertices[before], vertices[corners[k]], vertices[after], width);
    if (!leave_out) {
      k = (k + 1) % n;
      ++sound;
      continue;
    }
    // Look again at the corner before, whose neighbor is another one now.
    corners.erase(corners.begin() + signed_place(k));
    k = (k + n - 2) % (n - 1);
    sound = 0;
  }
  return corners;
}

Scene clean_corners(Scene scene) {
  const double width = weld_distance(scene);
  Faces repeated;
  for (Polygon& polygon : scene.polygons) {
    std::vector<std::uint32_t> kept = without_spikes(polygon.corners, scene.vertices, width);
    if (kept.size() == polygon.corners.size()) continue;
    // Those of which fewer than three corners are left have no area and are left out as such.
    if (kept.size() >= 3) repeated.push_back(model_face(scene, polygon));
    polygon.corners = std::move(kept);
  }
  return with_problem(std::move(scene), DiagnosticCode::repeated_corners, std::move(repeated),
                      "with corners that repeat the one before, or are the tips of spikes without width; left out");
}

// ", of wall" or ", of roof, wall, ...": the first five names.
std::string of_objects(std::set<std::string> names) {
  names.erase("");
  if (names.empty()) return "";
  std::string text = ", of ";
  std::size_t count = 0;
  for (const std::string& name : names) {
    if (++count > 5) return text + ", ...";
    text += (count > 1 ? ", " : "") + name;
  }
  return text;
}

// The objects of which no face is left.
Scene report_lost_objects(Scene scene, const std::set<std::string>& before) {
  const std::set<std::string> after = objects_with_faces(scene);
  std::set<std::string> lost;
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::inserter(lost, lost.end()));
  if (lost.empty()) return scene;
  const std::string what = counted(lost.size(), "object") + " without any sound face, left out" + of_objects(lost);
  scene.diagnostics.push_back({DiagnosticCode::left_out, what, lost.size()});
  return scene;
}

// Leaves out polygons without area and cuts those that are not simple and planar.
Scene make_simple(Scene scene) {
  const double width = weld_distance(scene);
  Faces narrow, crossing, lost, bent;
  std::set<std::string> narrow_objects, lost_objects;
  const std::set<std::string> objects = objects_with_faces(scene);
  std::vector<Polygon> polygons;
  polygons.reserve(scene.polygons.size());
  for (const Polygon& polygon : scene.polygons) {
    Pieces pieces = pieces_of(scene, polygon, width);
    if (pieces.defect == DiagnosticCode::zero_area) {
      narrow.push_back(model_face(scene, polygon));
      narrow_objects.insert(group_name(scene, polygon.group));
    }
    if (pieces.defect == DiagnosticCode::non_planar) bent.push_back(model_face(scene, polygon));
    if (pieces.defect == DiagnosticCode::self_intersecting) {
      (pieces.polygons.empty() ? lost : crossing).push_back(model_face(scene, polygon));
      if (pieces.polygons.empty()) lost_objects.insert(group_name(scene, polygon.group));
    }
    scene.vertices.insert(scene.vertices.end(), pieces.new_vertices.begin(), pieces.new_vertices.end());
    for (Polygon& piece : pieces.polygons) polygons.push_back(std::move(piece));
  }
  scene.polygons = std::move(polygons);
  scene = with_problem(std::move(scene), DiagnosticCode::zero_area, std::move(narrow),
                       "without area; left out" + of_objects(narrow_objects));
  scene = with_problem(std::move(scene), DiagnosticCode::non_planar, std::move(bent),
                       "with corners that do not lie in one plane; cut into triangles");
  scene = with_problem(std::move(scene), DiagnosticCode::self_intersecting, std::move(crossing),
                       "with an outline that crosses itself; cut at the crossings, all parts facing one way");
  scene =
      with_problem(std::move(scene), DiagnosticCode::little_left_out, std::move(lost),
                   "with an outline that crosses itself, without a clear area; left out" + of_objects(lost_objects));
  return report_lost_objects(std::move(scene), objects);
}

// More than 1 % of the area of the model makes results wrong.
Scene weigh_losses(Scene scene) {
  double area = 0, lost = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) area += polygon_area(scene, p);
  for (const Diagnostic& problem : scene.diagnostics) lost += is_loss(problem.code) ? problem.area : 0;
  if (lost <= 0.01 * (area + lost)) return scene;
  for (Diagnostic& problem : scene.diagnostics) {
    if (problem.code == DiagnosticCode::little_left_out && problem.area > 0) problem.code = DiagnosticCode::left_out;
  }
  return scene;
}

Scene merge_coincident(Scene scene) {
  const Coincidence found = find_coincident(scene);
  Faces duplicates, covered, two_sided, opened;
  std::size_t other_material = 0;
  for (const Coincidence::Pair& pair : found.pairs) {
    Polygon& first = scene.polygons[pair.first];
    const Polygon& second = scene.polygons[pair.second];
    const bool second_is_clear = is_opening(scene, pair.second);
    if (second_is_clear != is_opening(scene, pair.first)) {
      opened.push_back(model_face(scene, second_is_clear ? first : second));
      if (second_is_clear) first = second;
      continue;
    }
    if (!pair.same_front && !first.back_material) {
      two_sided.push_back(model_face(scene, second));
      first.back_material = second.material;
      first.back_texture_map = second.texture_map;
      continue;
    }
    const Side side = pair.same_front ? Side::front : Side::back;
    duplicates.push_back(model_face(scene, second));
    other_material += material_on(first, side) != second.material;
    if (emits(scene, pair.second, Side::front) && !emits(scene, pair.first, side)) {
      covered.push_back(model_face(scene, second));
    }
  }
  std::size_t place = 0;
  std::erase_if(scene.polygons, [&](const Polygon&) { return found.is_second[place++] != 0; });
  const std::string others =
      other_material > 0 ? ", " + std::to_string(other_material) + " of them with another material" : "";
  scene = with_problem(std::move(scene), DiagnosticCode::overlapping_faces, std::move(opened),
                       "at the place of a clear one: opened there");
  scene = with_problem(std::move(scene), DiagnosticCode::covered_lamp, std::move(covered),
                       "of lamps at the place of an earlier face that does not emit; the earlier face stays, so remove "
                       "it or move the lamp");
  scene = with_problem(std::move(scene), DiagnosticCode::duplicate_faces, std::move(duplicates),
                       "at the place of an earlier one with the same front" + others + "; the first stays");
  return with_problem(std::move(scene), DiagnosticCode::two_sided_faces, std::move(two_sided),
                      "back to back with an earlier one; the two become one polygon with a material on each side");
}

Scene report_shells(Scene scene) {
  const Shells shells = shells_of(scene);
  Faces turned, branched;
  std::size_t lamps = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!shells.turned[p] || scene.polygons[p].back_material) continue;
    turned.push_back(model_face(scene, scene.polygons[p]));
    lamps += is_lamp(scene, p);
  }
  for (const PolygonIndex p : shells.branched) branched.push_back(model_face(scene, scene.polygons[p]));
  const std::string shine = lamps > 0 ? ", " + counted(lamps, "lamp") + " among them" : "";
  scene =
      with_problem(std::move(scene), DiagnosticCode::turned_faces, std::move(turned),
                   "turned against the faces next to them" + shine +
                       "; they stay: mesh.sides=auto finds the right sides of closed shells, a lamp shines from its "
                       "front, mesh.sides=front shows the wrong side");
  if (branched.empty()) return scene;
  const std::string what = counted(shells.branched_edges, "edge") + " of three faces or more, " +
                           listed(scene, branched) +
                           " at them; mesh.sides=auto keeps both sides of shells joined there";
  scene.diagnostics.push_back({DiagnosticCode::non_manifold_edges, what, shells.branched_edges, std::move(branched)});
  return scene;
}

}  // namespace

Scene repair(Scene scene) {
  check_vertices(scene);
  scene = number_faces(std::move(scene));
  scene = report_far_faces(std::move(scene));
  scene = weld_vertices(std::move(scene));
  scene = clean_corners(std::move(scene));
  scene = weigh_losses(make_simple(std::move(scene)));
  scene = merge_coincident(std::move(scene));
  scene = with_openings_cut(std::move(scene));
  scene = with_solid_panes_as_one(std::move(scene));
  scene = report_shells(std::move(scene));
  scene.diagnostics = worst_first(std::move(scene.diagnostics));
  return scene;
}

}  // namespace patchlight
