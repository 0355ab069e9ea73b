#include "patchlight/plan/plan.h"

#include "patchlight/base/error.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "mesh/mesher.h"
#include "mesh/outline.h"
#include "plan/check_request.h"
#include "plan/choose_storage.h"
#include "plan/decide.h"
#include "plan/effect_facts.h"
#include "plan/first_light.h"
#include "plan/goal.h"
#include "plan/left_out_sides.h"
#include "plan/memory.h"
#include "plan/planned_lines.h"
#include "plan/survey.h"
#include "scene/coverings.h"
#include "scene/extent.h"
#include "scene/model_face.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace patchlight {
namespace {

std::string note_on_coarse(const std::string& faces, std::size_t corners, std::size_t left_out, double max_edge) {
  std::ostringstream text;
  text.precision(2);
  text << faces << " with an outline of up to " << corners
       << " corners, finer than the patches: these follow one of the same area without up to " << left_out
       << " of them, nowhere farther away than " << outline_tolerance * max_edge << " m";
  return text.str();
}

std::string note_on_kept(const std::string& faces, std::size_t corners) {
  return faces + " with an outline of up to " + std::to_string(corners) +
         " corners where other faces meet it or it turns, finer than the patches asked for: these are kept, so that "
         "each side takes " +
         std::to_string(corners - 2) + " patches at least; an outline of fewer corners takes fewer";
}

// What is worth saying of outlines that are finer than patches, in a mesh with edges of at most `max_edge` metres: of
// which faces patches follow a coarser outline; and which take a quarter of the `asked` patches or more for their
// corners alone, 0 standing for no such number.
Diagnostics notes_on_fine_outlines(const Scene& scene, const KeptSides& sides, std::size_t asked, double max_edge) {
  constexpr std::size_t parts = 4;  // of the patches asked for: a face that takes as many is worth a word
  constexpr std::size_t few = 24;   // corners that a round face keeps however large patches are
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
    if (asked == 0 || parts * (corners - left_out[p] - 2) < asked) continue;
    if (left_out[p] > 0 && corners - left_out[p] <= few) continue;
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

constexpr double farthest = 1.001e-3;  // metres: a millimetre, rounded
constexpr double in_plane = 1e-9;      // of the extent: what shadow rays take for in the plane

// Does the point lie over the polygon, seen along its normal?
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

// What is to be said of a luminaire at this height over the front of a face over which it lies; nothing where it is
// well before the side that it lights.
std::string trouble_at(const Luminaire& luminaire, double height, const Vector& normal, double nearest) {
  std::ostringstream text;
  text.precision(3);
  if (std::abs(height) <= nearest) {
    if (std::holds_alternative<PointLight>(luminaire.light))
      text << "in the plane of a face, so that half of its light goes to either side";
  } else if (height * luminaire.aim.dot(normal) < 0) {
    text << 1000 * std::abs(height) << " mm behind a face towards which it shines, so that it lights the other side";
  }
  return text.str();
}

// A sentence for each luminaire that lies up to 1 mm behind an opaque face towards which it shines, but not in its
// plane: its light falls on the side that is not meant, as on the roof when it is a little over the ceiling. And for
// each that shines in all directions from the plane of an opaque face: half of its light goes to either side.
Diagnostics notes_on_luminaires_behind(const Scene& scene) {
  Diagnostics notes;
  const double nearest = in_plane * extent_of(scene);
  for (const Luminaire& luminaire : scene.luminaires) {
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      const Vector normal = front_normal(scene, p);
      const double height = normal.dot(luminaire.position - scene.vertices[scene.polygons[p].corners[0]]);
      if (std::abs(height) > farthest || is_opening(scene, p)) continue;
      const std::string trouble = trouble_at(luminaire, height, normal, nearest);
      if (trouble.empty() || !lies_over(luminaire.position, corner_points(scene, p), normal)) continue;
      notes.push_back({DiagnosticCode::misplaced_luminaire,
                       "luminaire '" + luminaire.name + "' (" + luminaire.place + ") lies " + trouble + " (" +
                           place_of(scene, scene.polygons[p]) + "); move it if that is not meant"});
      break;
    }
  }
  return notes;
}

void require_lamp(const Scene& scene) {
  if (!has_lamp(scene)) throw InputError(scene.file, "no light source: " + first_light(scene).advice);
}

// A run without any light is not meant.
void require_light(const Scene& scene, const EffectFacts& facts, const std::vector<Decision>& decisions) {
  if (facts.lamps > 0) return;
  std::string skipped;
  for (const Decision& decision : decisions) {
    const bool is_light =
        decision.effect == Effect::luminaires || decision.effect == Effect::sun || decision.effect == Effect::sky;
    if (is_light && decision.simulate) return;
    if (is_light && decision.forced) skipped += std::string(skipped.empty() ? "" : ", ") + name_of(decision.effect);
  }
  if (skipped.empty()) return;
  throw InputError(scene.file, "no light source is left\nhint: keep one of those that are disabled: " + skipped);
}

bool simulates(const std::vector<Decision>& decisions, Effect effect) {
  return std::none_of(decisions.begin(), decisions.end(),
                      [effect](const Decision& decision) { return decision.effect == effect && !decision.simulate; });
}

// A sun below the horizon gives no light.
Diagnostics notes_on_sun(const Scene& scene) {
  if (!scene.sun || scene.sun->direction.dot(scene.up) > 0) return {};
  const double altitude = std::asin(std::max(-1.0, scene.sun->direction.dot(scene.up))) * 180 / std::numbers::pi;
  std::ostringstream text;
  text.precision(3);
  text << "the sun is " << -altitude << " degrees below the horizon and gives no light";
  return {{DiagnosticCode::sun_below_horizon, text.str()}};
}

Diagnostics notes_on_sheets(const EffectFacts& facts) {
  if (facts.sheets == 0) return {};
  return {{DiagnosticCode::translucent_sheet,
           std::to_string(facts.sheets) +
               (facts.sheets == 1 ? " face is a translucent sheet" : " faces are translucent sheets") +
               ", simulated on both sides; only the solvers gmres, bicgstab and jacobi can be used",
           facts.sheets}};
}

// What solve takes rows of rays for.
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

// Every kept side takes a patch at least. Of a model with many small faces the large ones have to be cut as well, as
// the light varies over them: a quarter more patches than the least goes to these.
std::size_t enough_patches(std::size_t asked, std::size_t least) {
  constexpr std::size_t few = 1000;  // for so few a quarter is not worth a word
  return least > few ? std::max(asked, least + least / 4) : asked;
}

std::string note_on_patches(const Scene& scene, std::size_t asked, std::size_t wanted) {
  return "the model's " + std::to_string(scene.polygons.size()) + " faces take " + std::to_string(wanted) +
         " patches, not " + std::to_string(asked) + ", so that large faces are divided as well";
}

// How finely the kept sides are cut.
struct PatchSize {
  double max_edge = 0;      // metres
  std::size_t patches = 0;  // about so many, or the least that the edge allows
  std::size_t around = 0;   // of these those of the surroundings of the goal
  Diagnostics notes;
};

// The kept sides with their lines, and what is known of the number of their patches.
struct Outlined {
  const Scene& scene;
  const KeptSides& sides;  // those of the goal
  const ContactLines& contacts;
  EdgeSearch& search;
  const Goal* goal = nullptr;
};

// The longest edge of parents whose parts are about so many. Of parents large ones are cut in four, and small ones stay
// whole: of a model with many small faces the number of parents lies anywhere between a quarter of them and all.
double parents_edge_for(EdgeSearch& search, std::size_t wanted) {
  constexpr double enough = 0.8;
  // What no memory holds is refused later, and not meshed to find that out.
  constexpr std::size_t too_many = 5'000'000;
  if (wanted > too_many) return 2 * search.edge_for(wanted);
  const double edge = search.edge_for(wanted / 4);
  // Where nearly every patch is a face as it is, few tell whether the large faces are cut.
  const auto least = static_cast<double>(search.least_patches());
  const auto beyond_faces = [least](double patches) { return std::max(0.0, patches - least); };
  if (beyond_faces(search.nested_patches_with(edge)) >= enough * beyond_faces(static_cast<double>(wanted))) return edge;
  return search.nested_edge_for(wanted);
}

// What is refined begins with no more than it has to; but so many rows of rays are not traced twice for nothing.
std::size_t patches_wanted(std::size_t asked, std::size_t least, const Request& request) {
  const bool begins_coarse = refines(request.accuracy) && request.assembly.storage != Storage::rays;
  return begins_coarse ? std::max(asked, least) : enough_patches(asked, least);
}

// About so many patches there will be, or the least that the edge asked for allows.
std::size_t expected_patches(const Outlined& of, const Request& request) {
  if (request.mesh.max_edge) return least_patches_with(of.scene, of.sides, *request.mesh.max_edge, of.contacts);
  return patches_wanted(patches_asked(request), of.search.least_patches(), request);
}

std::size_t kept_side_count(const KeptSides& sides) {
  const auto kept = [](const std::vector<std::uint8_t>& side) {
    return static_cast<std::size_t>(std::count(side.begin(), side.end(), std::uint8_t{1}));
  };
  return kept(sides.front) + kept(sides.back);
}

// The largest edge for the number of patches that is asked for.
PatchSize patch_size_for(std::size_t asked, const Outlined& of, const Request& request) {
  const std::size_t least = of.search.least_patches();
  const double share = of.goal != nullptr ? of.goal->share_of_surroundings : 0;
  const auto around = static_cast<std::size_t>(std::lround(share * static_cast<double>(asked)));
  const std::size_t wanted = patches_wanted(asked - around, least, request);
  // A nested mesh is made from parents with edges twice as long.
  PatchSize size{
      has_error_bars(request.accuracy) ? parents_edge_for(of.search, wanted) / 2 : of.search.edge_for(wanted),
      wanted + around,
      around,
      {}};
  if (wanted > asked && !refines(request.accuracy))
    size.notes.push_back({DiagnosticCode::more_patches, note_on_patches(of.scene, asked, wanted)});
  return size;
}

PatchSize patch_size(const Outlined& of, const Request& request) {
  assert(!request.mesh.max_edge || *request.mesh.max_edge > 0);
  const std::size_t asked = request.mesh.max_edge ? 0 : patches_asked(request);
  PatchSize size = request.mesh.max_edge ? PatchSize{*request.mesh.max_edge, expected_patches(of, request), 0, {}}
                                         : patch_size_for(asked, of, request);
  const double outline_edge = has_error_bars(request.accuracy) ? 2 * size.max_edge : size.max_edge;
  size.notes = merged({problems_with_size(of.scene), std::move(size.notes),
                       notes_on_fine_outlines(of.scene, of.sides, asked, outline_edge)});
  return size;
}

// Error bars follow from the errors of the entries.
AssemblyOptions decided(AssemblyOptions assembly, const Request& request, bool close) {
  assembly.close = close;
  const bool of_pairs = assembly.storage != Storage::rays && has_error_bars(request.accuracy);
  assembly.keep_errors = assembly.keep_errors || of_pairs;
  return assembly;
}

// By what is simulated. With light that is not reflected again the rows of the lamps are enough, and no matrix is
// needed. By force every pair takes its rays, also those between which nothing is found to stand.
AssemblyOptions decided(const Request& request, const EffectFacts& facts, const std::vector<Decision>& decisions,
                        const Given& given) {
  AssemblyOptions assembly = decided(request.assembly, request, simulates(decisions, Effect::closure));
  const bool lamps_alone = !simulates(decisions, Effect::interreflection) && !assembly.close && !assembly.keep_errors &&
                           assembly.estimator == Estimator::automatic;
  if (lamps_alone && !given.form_factors && assembly.storage == Storage::tiles) assembly.storage = Storage::on_demand;
  if (simulates(decisions, Effect::occlusion) && facts.inside_hull == 0) assembly.short_cuts.free = false;
  return assembly;
}

SolverOptions decided(SolverOptions solver) {
  solver.relative_error = tolerance_of(solver);
  return solver;
}

// Of sheets R is not diagonal, and may have negative eigenvalues.
SolverOptions decided(SolverOptions solver, bool every_band, const AssemblyOptions& assembly,
                      const EffectFacts& facts) {
  if (facts.sheets > 0 && solver.solver == Solver::cg) solver.solver = Solver::gmres;
  if (assembly.storage == Storage::rays && !solver.relative_error)
    solver.relative_error = default_ray_tolerance(assembly.rays);
  solver.every_band = solver.every_band || every_band;
  return decided(std::move(solver));
}

AccuracyOptions decided(AccuracyOptions accuracy) {
  accuracy.error_bars = has_error_bars(accuracy);
  return accuracy;
}

}  // namespace

Plan make_plan(const Scene& scene, const Request& asked, const Given& given) {
  require_lamp(scene);
  KeptSides sides = sides_for(scene, asked);
  const auto coverings = std::make_shared<const Coverings>(find_coverings(scene, sides));
  // Form factors that are given belong to a mesh that knows of no light.
  const bool knows_lights = !given.form_factors && !given.ray_rows && !given.mesh;
  // An edge that is asked for is that of all patches.
  const bool has_goal = knows_lights && !asked.mesh.max_edge;
  const std::shared_ptr<const Goal> goal =
      has_goal ? find_goal(scene, sides, *coverings, asked.accuracy.interest, asked.assembly.seed) : nullptr;
  const KeptSides of_goal = sides_of_goal(sides, goal.get());
  auto [contacts, notes_on_contacts] = planned_lines(scene, asked, sides, *coverings, knows_lights);
  const EffectFacts facts = survey_effects(scene, sides);
  const bool reflects = simulates(decide(facts, asked), Effect::interreflection);
  const bool mirrors =
      (has_reflections(facts) && !contains(asked.effects.skip, Effect::mirrors)) || facts.coloured_specular > 0;
  EdgeSearch search(scene, of_goal, contacts);
  const Outlined outlined{scene, of_goal, contacts, search, goal.get()};
  const auto [request, notes_on_storage] =
      choose_storage(asked, given,
                     {.patches = expected_patches(outlined, asked) + kept_side_count(sides) - kept_side_count(of_goal),
                      .sides = kept_side_count(sides),
                      .is_reflected = reflects,
                      .is_mirrored = mirrors,
                      .has_goal = goal != nullptr,
                      .has_sensors = !scene.sensors.empty()});
  require_rays_for_colours(facts.coloured_specular, request, asked, given);
  PatchSize size = patch_size(outlined, request);
  std::vector<Decision> decisions = decide(facts, request);
  require_light(scene, facts, decisions);

  // One band stands for all where nothing changes the colour of light.
  const bool one_colour = facts.grey && facts.lamp_colour.has_value();
  const bool in_colour = simulates(decisions, Effect::colour);
  const auto left_out = [&] { return notes_on_left_out_sides(scene, *asked.mesh.kept_sides, asked.mesh.sides); };
  return {.sides = std::move(sides),
          .coverings = coverings,
          .contacts = std::move(contacts),
          .graded_edges = asked.mesh.graded_edges,
          .max_edge = size.max_edge,
          .goal = goal,
          .patches_around = size.around,
          .assembly = decided(request, facts, decisions, given),
          .solver = decided(request.solver, in_colour && one_colour, request.assembly, facts),
          .accuracy = decided(request.accuracy),
          .resources = request.resources,
          .decisions = std::move(decisions),
          .lamp_colour = !in_colour && one_colour ? *facts.lamp_colour : Spectrum(),
          .notes = merged({std::move(size.notes), notes_on_storage, std::move(notes_on_contacts),
                           notes_on_overruling(facts, request), notes_on_sun(scene), notes_on_sheets(facts),
                           notes_on_luminaires_behind(scene), request.mesh.kept_sides ? left_out() : Diagnostics()})};
}

Plan plan_form_factors(const Scene& scene, const Request& request) {
  KeptSides sides = sides_for(scene, request);
  const auto coverings = std::make_shared<const Coverings>(find_coverings(scene, sides));
  require_rays_for_colours(coloured_specular(scene, sides), request, request);
  auto [contacts, notes_on_contacts] = planned_lines(scene, request, sides, *coverings, false);
  EdgeSearch search(scene, sides, contacts);
  PatchSize size = patch_size({scene, sides, contacts, search}, request);
  const bool close = request.assembly.close && keeps_entries(request.assembly.storage) &&
                     !contains(request.effects.skip, Effect::closure);
  return {.sides = std::move(sides),
          .coverings = coverings,
          .contacts = std::move(contacts),
          .graded_edges = request.mesh.graded_edges,
          .max_edge = size.max_edge,
          .assembly = decided(request.assembly, request, close),
          .solver = decided(request.solver),
          .accuracy = decided(request.accuracy),
          .resources = request.resources,
          .decisions = {},
          .notes = merged({std::move(size.notes), notes_on_pairs(scene, request), std::move(notes_on_contacts)})};
}

bool refines(const AccuracyOptions& accuracy) { return accuracy.relative_error || accuracy.seconds; }

bool has_error_bars(const AccuracyOptions& accuracy) { return accuracy.error_bars || refines(accuracy); }

std::size_t patches_asked(const Request& request) {
  return request.mesh.patches.value_or(refines(request.accuracy) ? first_patches : default_patches);
}

KeptSides sides_for(const Scene& scene, const Request& request) {
  const std::optional<KeptSides>& kept = request.mesh.kept_sides;
  assert(!kept || kept->front.size() == scene.polygons.size());
  if (kept) return *kept;
  return kept_sides(scene, request.mesh.sides,
                    {.unreached = contains(request.effects.force, Effect::reach),
                     .turned_away = contains(request.effects.force, Effect::backs)});
}

bool simulates(const Plan& plan, Effect effect) { return simulates(plan.decisions, effect); }

}  // namespace patchlight
