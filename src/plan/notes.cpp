#include "plan/notes.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "mesh/mesher.h"
#include "mesh/outline.h"
#include "plan/survey.h"
#include "scene/extent.h"
#include "scene/model_face.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

namespace patchlight {
namespace {

std::string advice_for(const Scene& scene, double nearest) {
  const char* const by_outline = "cut the surface along the lamp's outline, or move the lamp into the surface";
  // Patches that small are no remedy where the scene takes too many of them.
  if (area_of_faces(scene) > 100'000 * nearest * nearest) return by_outline;
  std::ostringstream edge;
  edge << nearest / scene.metres_per_unit;
  return "compare with mesh.max_edge=" + edge.str() + " in the model's units, or " + by_outline;
}

constexpr const char* advice_to_recompute = "\nhint: compute the form factors again with the present lamps";

// Names of the materials that emit, but from no kept side.
std::vector<std::string> dark_lamps(const Scene& scene, const KeptSides& kept) {
  std::vector<std::uint8_t> emits_somewhere(scene.materials.size(), 0);
  std::vector<std::uint8_t> emits_from_kept(scene.materials.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      if (!emits(scene, p, side)) continue;
      const MaterialIndex material = material_on(scene.polygons[p], side);
      emits_somewhere[material] = 1;
      if (is_kept(kept, p, side)) emits_from_kept[material] = 1;
    }
  }
  std::vector<std::string> names;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (emits_somewhere[m] && !emits_from_kept[m]) names.push_back(scene.materials[m].name);
  }
  return names;
}

std::string note_on_coarse(const std::string& faces, std::size_t corners, std::size_t left_out, double max_edge) {
  std::ostringstream text;
  text.precision(2);
  text << faces << " with an outline of up to " << corners
       << " corners, finer than the patches: these follow an outline of the same area without up to " << left_out
       << " of them, at most " << outline_tolerance * max_edge << " m away";
  return text.str();
}

std::string note_on_kept(const std::string& faces, std::size_t corners) {
  return faces + " with an outline of up to " + std::to_string(corners) +
         " corners where other faces meet it or it turns, finer than the requested patches: these are kept, so that "
         "each side needs " +
         std::to_string(corners - 2) + " patches at least; an outline of fewer corners needs fewer";
}

// True when the point lies over the polygon, seen along its normal.
bool lies_over(const Point& point, const std::vector<Point>& corners, const Vector& normal) {
  const auto triangles = triangulate(corners);
  const auto is_left = [&](std::size_t a, std::size_t b) {
    return normal.dot((corners[b] - corners[a]).cross(point - corners[a])) >= 0;
  };
  return std::any_of(triangles.begin(), triangles.end(), [&](const auto& triangle) {
    const auto& [a, b, c] = triangle;
    return is_left(a, b) && is_left(b, c) && is_left(c, a);
  });
}

// The trouble with a luminaire at this height over the front of a face over which it lies; empty where it is well
// before the side that it lights.
std::string trouble_at(const Luminaire& luminaire, double height, const Vector& normal, double nearest) {
  if (std::abs(height) <= nearest)
    return std::holds_alternative<PointLight>(luminaire.light)
               ? "in the plane of a face, so that half of its light goes to either side"
               : "";
  if (!(height * luminaire.aim.dot(normal) < 0)) return {};
  return rounded(1000 * std::abs(height)) +
         " mm behind a face towards which it shines, so that it lights the other side";
}

}  // namespace

Diagnostics notes_on_close_lamps(const Scene& scene, const Occluder& occluder, double max_edge) {
  std::vector<Ray> rays;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      if (!emits(scene, p, side)) continue;
      const Vector normal = side == Side::front ? front_normal(scene, p) : Vector(-front_normal(scene, p));
      rays.push_back({area_centroid(corner_points(scene, p)), normal, p});
    }
  }
  const std::vector<std::optional<Hit>> hits = occluder.first_hits(rays);
  std::size_t count = 0;
  double nearest = max_edge / 2;
  PolygonIndex lamp = no_polygon;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    // A lamp may hide others of its own kind.
    if (!hits[k] || is_lamp(scene, hits[k]->polygon) || hits[k]->distance >= max_edge / 2) continue;
    ++count;
    if (hits[k]->distance >= nearest) continue;
    nearest = hits[k]->distance;
    lamp = rays[k].from_polygon;
  }
  if (lamp == no_polygon) return {};
  std::ostringstream note;
  note << count << (count == 1 ? " lamp faces" : " lamps face")
       << " a surface nearer than the size of its patches (nearest: " << place_of(scene, scene.polygons[lamp]) << ", "
       << nearest << " m, patches up to " << max_edge
       << " m): the light between them is spread too far and results may be wrong by a large factor; "
       << advice_for(scene, nearest);
  return {{DiagnosticCode::close_lamp, note.str(), count}};
}

Diagnostics notes_on_left_out_sides(const Scene& scene, const KeptSides& kept, Sides sides) {
  Diagnostics notes;
  for (const std::string& name : dark_lamps(scene, kept)) {
    notes.push_back({DiagnosticCode::lost_light,
                     "material '" + name + "' emits, but no light comes from it: its faces were left out of the " +
                         "form factors" + advice_to_recompute});
  }
  const KeptSides now = kept_sides(scene, sides);
  std::size_t left_out = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) left_out += is_kept(now, p, side) && !is_kept(kept, p, side);
  }
  if (left_out == 0) return notes;
  notes.push_back(
      {DiagnosticCode::lost_light,
       "with these lamps " + counted(left_out, "side") +
           " of faces would be included that were left out when the form factors were computed: light that arrives "
           "there is lost" +
           advice_to_recompute});
  return notes;
}

Diagnostics notes_on_fine_outlines(const Scene& scene, const KeptSides& sides, std::size_t asked, double max_edge) {
  const std::vector<std::size_t> left_out = left_out_corners(scene, max_edge);
  std::vector<ModelFace> coarse, kept;
  std::size_t most = 0, most_left_out = 0, most_kept = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::size_t corners = scene.polygons[p].corners.size();
    if (!(sides.front[p] || sides.back[p]) || corners <= 4) continue;
    const auto face = [&] { return model_face(scene, scene.polygons[p]); };
    if (left_out[p] > 0) {
      coarse.push_back(face());
      most = std::max(most, corners);
      most_left_out = std::max(most_left_out, left_out[p]);
    }
    if (asked == 0 || 4 * (corners - left_out[p] - 2) < asked) continue;
    if (left_out[p] > 0 && corners - left_out[p] <= 24) continue;  // a round face keeps these in any case
    kept.push_back(face());
    most_kept = std::max(most_kept, corners - left_out[p]);
  }
  Diagnostics notes;
  if (!coarse.empty())
    notes.push_back(
        {DiagnosticCode::fine_outline, note_on_coarse(listed(scene, coarse), most, most_left_out, max_edge)});
  if (!kept.empty()) notes.push_back({DiagnosticCode::fine_outline, note_on_kept(listed(scene, kept), most_kept)});
  return notes;
}

Diagnostics notes_on_luminaires_behind(const Scene& scene) {
  Diagnostics notes;
  const double nearest = tolerance_of_shapes * extent_of(scene);
  for (const Luminaire& luminaire : scene.luminaires) {
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      const Vector normal = front_normal(scene, p);
      const double height = normal.dot(luminaire.position - scene.vertices[scene.polygons[p].corners[0]]);
      if (std::abs(height) > 1.001e-3 || is_opening(scene, p)) continue;  // a millimeter, rounded
      const std::string trouble = trouble_at(luminaire, height, normal, nearest);
      if (trouble.empty() || !lies_over(luminaire.position, corner_points(scene, p), normal)) continue;
      notes.push_back({DiagnosticCode::misplaced_luminaire, "luminaire '" + luminaire.name + "' (" + luminaire.place +
                                                                ") lies " + trouble + " (" +
                                                                place_of(scene, scene.polygons[p]) + "); move it"});
      break;
    }
  }
  return notes;
}

Diagnostics notes_on_sun(const EffectFacts& facts) {
  if (!facts.sun_altitude || *facts.sun_altitude > 0) return {};
  return {{DiagnosticCode::sun_below_horizon,
           "the sun is " + rounded(-*facts.sun_altitude) + " degrees below the horizon and gives no light"}};
}

Diagnostics notes_on_sheets(const EffectFacts& facts) {
  if (facts.sheets == 0) return {};
  return {{DiagnosticCode::translucent_sheet,
           std::to_string(facts.sheets) +
               (facts.sheets == 1 ? " face is a translucent sheet" : " faces are translucent sheets") +
               ", simulated on both sides; only the solvers gmres, bicgstab and jacobi can be used",
           facts.sheets}};
}

Diagnostics notes_on_pairs(const Scene& scene, const Request& request) {
  if (!keeps_entries(request.assembly.storage)) return {};
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_reflecting_pane(scene, p) || is_mirror(scene, p, Side::front) || is_mirror(scene, p, Side::back))
      return {
          {DiagnosticCode::unfollowed_reflection,
           "the pair method ignores light that glazing and mirrors reflect\nhint: assembly.storage=rays, as a solve "
           "does by itself"}};
  }
  return {};
}

}  // namespace patchlight
