#include "patchlight/scene/sides.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/model_face.h"
#include "scene/shells.h"
#include "scene/simple_polygon.h"
#include "scene/solids.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

constexpr std::size_t most_lid_triangles = 1000;

// The rims of one shell as outlines of faces that would close it, which walk along each edge against its polygon.
// Nothing where rims meet in a vertex.
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
  double near;    // meters
  double extent;  // meters, of the scene

  // Do opaque faces of other shells fill the outline? The rest of it is then narrower than `near`.
  bool is_closed(const std::vector<Point>& outline, PolygonIndex shell) const {
    FlatFace rim = flat_face(outline);
    // The corners decide whether faces share its plane.
    const FaceQuery query{.box = with_margin(rim.box, near),
                          .normal = rim.normal,
                          .tilt = 0.05,
                          .offset = rim.normal.dot(outline[0]),
                          .tolerance = extent};
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

  bool shares_plane(PolygonIndex polygon, const std::vector<Point>& outline) const {
    const Vector& normal = tree.face(polygon).normal;
    const Point& on_plane = scene.vertices[scene.polygons[polygon].corners[0]];
    return std::all_of(outline.begin(), outline.end(),
                       [&](const Point& corner) { return std::abs(normal.dot(corner - on_plane)) <= near; });
  }

  bool can_close(const std::vector<Point>& outline, PolygonIndex shell) const {
    return outline.size() >= 3 && !is_narrow(outline, near) && !crosses_itself(outline) && is_closed(outline, shell);
  }

  // The corners from `first` on, as many as lie in one plane, if faces fill this polygon.
  std::optional<std::vector<Point>> closed_run(const std::vector<Point>& outline, std::size_t first,
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

  // An outline in several planes, for example of a wall with a door, loses runs of corners that faces fill, one by one.
  std::optional<std::vector<Triangle>> lids_over(std::vector<Point> outline, PolygonIndex shell) const {
    std::vector<Triangle> lids;
    const auto add = [&](const std::vector<Point>& lid) {
      const std::vector<Triangle> triangles = triangles_of(lid);
      lids.insert(lids.end(), triangles.begin(), triangles.end());
    };
    while (!can_close(outline, shell)) {
      if (outline.size() > 64) return std::nullopt;
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
  std::optional<std::vector<Triangle>> lids(const std::vector<RimEdge>& edges) const {
    if (edges.size() > 1000) return std::nullopt;
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
};

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

// Shells with rims that other shells close, as solids: a block without a bottom on a floor, a column without ends, a
// cupboard without a back before a wall. Every rim runs in one plane, within weld_distance(), over opaque faces that
// fill it. Their triangles include lids over the rims, which belong to no polygon. Rims of more than 1000 corners, and
// those that more than 1000 triangles lie under, are left open. O(n log n) for n polygons, expected.
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

// Counts for the notes.
struct Count {
  int dark = 0;     // solids without a lamp: inner sides left out
  int outside = 0;  // solids that hold every lamp: outer sides left out
  int outward = 0;  // solids with outward normals that hold a lamp: inner sides kept
  int sealed = 0;   // solids that hold a lamp, and that daylight is all around but does not get into
  std::uint32_t first_outward_line = 0;
};

Diagnostics notes_on(const Count& count) {
  const auto solids = [](int number) { return counted(static_cast<std::size_t>(number), "closed solid"); };
  Diagnostics notes;
  if (count.dark > 0)
    notes.push_back(
        {DiagnosticCode::unlit_sides, "the inner sides of " + solids(count.dark) + " without a lamp are left out"});
  if (count.outside > 0) {
    notes.push_back({DiagnosticCode::unlit_sides, "the outer sides of " + solids(count.outside) +
                                                      " around all lamps (usually the room) are left out"});
  }
  if (count.sealed > 0) {
    notes.push_back({DiagnosticCode::sealed_solid, "no daylight gets into " + solids(count.sealed) +
                                                       " around lamps, as no face of " +
                                                       (count.sealed == 1 ? "it" : "them") + " lets light through"});
  }
  if (count.outward > 0) {
    const std::string line =
        count.first_outward_line > 0 ? " (line " + std::to_string(count.first_outward_line) + ")" : std::string();
    notes.push_back({DiagnosticCode::outward_normals,
                     solids(count.outward) + line + " with outward normals around a lamp: the inner sides are used"});
  }
  return notes;
}

// The note on luminaires just outside of a room without any other: often their position is wrong by the thickness of a
// ceiling. A room is a closed solid that looks inward and is most of the scene.
std::string nearest_outside(const Scene& scene, const std::vector<Solid>& dark) {
  const double half = bounds(scene).volume() / 2;
  double least = 1;  // m
  const Luminaire* nearest = nullptr;
  for (const Solid& solid : dark) {
    if (!solid.fronts_face_inside || solid.box.volume() <= half) continue;
    for (const Luminaire& luminaire : scene.luminaires) {
      if (solid.box.exteriorDistance(luminaire.position) >= least) continue;
      const double distance = distance_to(solid, luminaire.position);
      if (!(distance < least)) continue;
      least = distance;
      nearest = &luminaire;
    }
  }
  if (nearest == nullptr) return {};
  return "no luminaire stands in the room: '" + nearest->name + "' (" + nearest->place + ") is the nearest, " +
         rounded(least) + " m outside";
}

std::string name_of_solid(const Scene& scene, const Solid& solid) {
  const Polygon& first = scene.polygons[solid.polygons.front()];
  const std::string group = group_name(scene, first.group);
  return "'" + group + "' (" + place_of(scene, first) + ")";
}

// At 2 * polygon + side.
using SideMask = std::vector<std::uint8_t>;

std::size_t at(PolygonIndex polygon, Side side) { return std::size_t{2} * polygon + static_cast<std::size_t>(side); }

SideMask either(SideMask first, const SideMask& second) {
  for (std::size_t k = 0; k < first.size(); ++k) first[k] |= second[k];
  return first;
}

// The sides of polygons that lie beside this box for sure, sharing no volume with it, and do not look into it.
SideMask sides_beside(const Scene& scene, const Box& room) {
  SideMask mask(2 * scene.polygons.size(), 0);
  const double extent = extent_of(scene);
  const Box inner = with_margin(room, -tolerance_of_coordinates * extent);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (polygon_box(scene, p).intersects(inner)) continue;
    for (const Side side : {Side::front, Side::back})
      mask[at(p, side)] = !room.contains(point_before(scene, p, side, extent));
  }
  return mask;
}

// The sides that lie outside of one of these solids for sure: the outer ones of its own polygons, and those beside it.
SideMask sides_outside(const Scene& scene, const Shells& shells, const std::vector<Solid>& solids) {
  SideMask mask(2 * scene.polygons.size(), 0);
  for (const Solid& solid : solids) {
    for (const PolygonIndex p : solid.polygons)
      mask[at(p, inner_side(solid, shells, p) == Side::front ? Side::back : Side::front)] = 1;
    mask = either(std::move(mask), sides_beside(scene, solid.box));
  }
  return mask;
}

bool shines_before(const Luminaire& luminaire, const Point& on_plane, const Vector& normal, double extent) {
  const auto* const sphere = std::get_if<SphericalLamp>(&luminaire.light);
  const double height = normal.dot(luminaire.position - on_plane) + (sphere != nullptr ? sphere->radius : 0);
  return height > tolerance_of_arithmetic * extent;
}

// The sides before which nothing lies and no light is: they see nothing. Lamps shine all the same.
SideMask sides_before_nothing(const Scene& scene, double extent) {
  SideMask mask(2 * scene.polygons.size(), 0);
  const HalfSpaces occupied = occupied_half_spaces(scene);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      if ((side == Side::front ? occupied.before : occupied.behind)[p] || emits(scene, p, side)) continue;
      const Vector normal = (side == Side::front ? 1 : -1) * front_normal(scene, p);
      const Point& on_plane = scene.vertices[scene.polygons[p].corners[0]];
      mask[at(p, side)] =
          std::none_of(scene.luminaires.begin(), scene.luminaires.end(),
                       [&](const Luminaire& luminaire) { return shines_before(luminaire, on_plane, normal, extent); });
    }
  }
  const bool all_dark = std::all_of(mask.begin(), mask.end(), [](std::uint8_t dark) { return dark != 0; });
  return all_dark ? SideMask(mask.size(), 0) : mask;
}

// Sides in the dark, of both kinds.
struct DarkSides {
  SideMask unreached;
  SideMask turned_away;
};

// Leaves these sides out, or keeps them on request.
KeptSides without(KeptSides kept, const DarkSides& dark, const KeptInTheDark& wanted) {
  for (std::size_t k = 0; k < dark.unreached.size(); ++k) {
    std::uint8_t& is_kept_side = (k % 2 == 0 ? kept.front : kept.back)[k / 2];
    if (dark.unreached[k]) {
      ++kept.unreached;
      is_kept_side = wanted.unreached;
    } else if (dark.turned_away[k]) {
      ++kept.turned_away;
      is_kept_side = wanted.turned_away;
    }
  }
  return kept;
}

// Light that arrives on one side of a sheet leaves the other: both are in the dark, or none.
DarkSides with_whole_sheets(DarkSides dark, const Scene& scene) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::size_t front = at(p, Side::front), back = at(p, Side::back);
    const bool all_dark =
        (dark.unreached[front] | dark.turned_away[front]) != 0 && (dark.unreached[back] | dark.turned_away[back]) != 0;
    if (all_dark || !is_sheet(scene, p)) continue;
    for (const std::size_t side : {front, back}) dark.unreached[side] = dark.turned_away[side] = 0;
  }
  return dark;
}

// The sides of a solid that are lit. Clear faces and sheets let light through, in and out.
LampPlaces lit_sides(const Solid& solid, const LampPlaces& lamps, bool daylight) {
  const bool from_outside = daylight || lamps.outside;
  const bool gets_out = lamps.inside && solid.has_opening;
  return {lamps.inside || (from_outside && solid.has_opening), !lamps.inside || from_outside || gets_out};
}

// The solids of a scene by the light that gets to them.
struct LitSolids {
  std::vector<Solid> dark;
  std::vector<Solid> around_all_lamps;
  Count count;
  std::string outside;  // a note on a luminaire that misses its room
};

LitSolids lit_solids(const Scene& scene, const SceneGeometry& geometry, const std::vector<LampShape>& lamps,
                     double extent) {
  const bool daylight = scene.sun || scene.sky;
  LitSolids lit;
  bool holds_lamp = false;
  for (const Solid& solid : geometry.solids) {
    const LampPlaces places = places_of(lamps, solid, extent);
    const auto [inside, outside] = lit_sides(solid, places, daylight);
    holds_lamp = holds_lamp || places.inside;
    if (inside && !solid.fronts_face_inside && lit.count.outward++ == 0)
      lit.count.first_outward_line = scene.polygons[solid.polygons[0]].line;
    lit.count.sealed += daylight && inside && !solid.has_opening;
    if (!inside)
      lit.dark.push_back(solid);
    else if (!outside)
      lit.around_all_lamps.push_back(solid);
  }
  if (!holds_lamp) lit.outside = nearest_outside(scene, lit.dark);
  // A solid that other faces close may be dark inside. Which part of those faces lies inside is unknown, so the outside
  // of one that holds all lamps is kept.
  for (Solid& solid : standing_solids(scene, geometry.shells)) {
    if (!lit_sides(solid, places_of(lamps, solid, extent), daylight).inside) lit.dark.push_back(std::move(solid));
  }
  lit.count.dark = static_cast<int>(lit.dark.size());
  lit.count.outside = static_cast<int>(lit.around_all_lamps.size());
  return lit;
}

KeptSides automatic_sides(const Scene& scene, const KeptInTheDark& in_the_dark,
                          std::shared_ptr<const SceneGeometry> geometry) {
  KeptSides kept;
  kept.front.assign(scene.polygons.size(), 1);
  kept.back.assign(scene.polygons.size(), 1);
  const double extent = extent_of(scene);
  const std::vector<LampShape> lamps = lamp_shapes(scene, extent);
  const bool daylight = scene.sun || scene.sky;
  kept.geometry = std::move(geometry);
  const Shells& shells = kept.geometry->shells;
  LitSolids lit = lit_solids(scene, *kept.geometry, lamps, extent);
  for (const Solid& solid : lit.dark) kept.dark_solids.push_back({name_of_solid(scene, solid), solid.polygons.size()});
  if (in_the_dark.unreached) lit.count.dark = 0;
  if (in_the_dark.turned_away) lit.count.outside = 0;
  kept.notes = notes_on(lit.count);
  if (!lit.outside.empty() && !in_the_dark.unreached)
    kept.notes.push_back({DiagnosticCode::misplaced_luminaire, lit.outside});
  // Where nothing is lit, things in a dark solid are no darker than the rest.
  const bool any_light = daylight || !lamps.empty();
  const SideMask unreached = any_light ? sides_within(scene, shells, lit.dark) : inner_sides(scene, shells, lit.dark);
  SideMask turned_away = sides_outside(scene, shells, lit.around_all_lamps);
  if (any_light && !daylight) turned_away = either(std::move(turned_away), sides_before_nothing(scene, extent));
  return without(std::move(kept), with_whole_sheets({unreached, std::move(turned_away)}, scene), in_the_dark);
}

}  // namespace

const char* name_of(Sides sides) {
  constexpr std::array names = {"auto", "front", "both"};
  return names[static_cast<std::size_t>(sides)];
}

std::vector<Solid> dark_solids(const Scene& scene) {
  const double extent = extent_of(scene);
  const std::vector<LampShape> lamps = lamp_shapes(scene, extent);
  if (lamps.empty() && !scene.sun && !scene.sky) return {};
  return lit_solids(scene, compute_geometry(scene), lamps, extent).dark;
}

KeptSides kept_sides(const Scene& scene, Sides sides, const KeptInTheDark& in_the_dark,
                     std::shared_ptr<const SceneGeometry> geometry) {
  if (!geometry) geometry = std::make_shared<const SceneGeometry>(compute_geometry(scene));
  if (sides == Sides::automatic) return automatic_sides(scene, in_the_dark, std::move(geometry));
  KeptSides kept;
  kept.geometry = std::move(geometry);
  kept.front.assign(scene.polygons.size(), 1);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const bool has_back = scene.polygons[p].back_material.has_value() || is_sheet(scene, p);
    kept.back.push_back(sides == Sides::both || has_back ? 1 : 0);
  }
  kept.emit_from_back = sides == Sides::both;
  if (kept.emit_from_back)
    kept.notes.push_back(
        {DiagnosticCode::both_sides, "lamps emit from both sides: twice the flux of their front sides"});
  return kept;
}

double kept_area(const Scene& scene, const KeptSides& sides) {
  double area = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    area += (sides.front[p] + sides.back[p]) * polygon_area(scene, p);
  }
  return area;
}

}  // namespace patchlight
