#include "plan/decide.h"

#include "base/words.h"
#include "light/pane.h"
#include "light/texture.h"
#include "plan/survey.h"
#include "scene/model_face.h"
#include "scene/solids.h"
#include "scene/spectral_bands.h"
#include "visibility/flat_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// The materials of kept sides, each once.
std::vector<const Material*> materials_in_use(const Scene& scene, const KeptSides& kept) {
  std::vector<std::uint8_t> used(scene.materials.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back})
      if (is_kept(kept, p, side)) used[material_on(scene.polygons[p], side)] = 1;
  }
  std::vector<const Material*> materials;
  for (std::size_t m = 0; m < used.size(); ++m) {
    if (used[m]) materials.push_back(&scene.materials[m]);
  }
  return materials;
}

bool is_constant(const Spectrum& spectrum) { return spectrum.size() == 0 || (spectrum == spectrum[0]).all(); }

// Transmitted and mirrored light keeps its color.
bool has_grey_passage(const Material& material) {
  return is_constant(material.transmittance) && is_constant(material.specular_reflectance);
}

bool is_grey(const Material& material) {
  return is_constant(material.reflectance) && is_constant(material.diffuse_transmittance);
}

// The largest share that is scattered, to either side.
double highest_scattered(const Material& material) {
  if (material.diffuse_transmittance.size() == 0) return material.reflectance.maxCoeff();
  return (material.reflectance + material.diffuse_transmittance).maxCoeff();
}

// Every material counts for transmittance: faces without kept sides color daylight, too.
bool is_grey(const Scene& scene, const std::vector<const Material*>& in_use) {
  return std::all_of(in_use.begin(), in_use.end(), [](const Material* m) { return is_grey(*m); }) &&
         std::all_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return has_grey_passage(m); });
}

// The spectra of all emitting materials and other lights.
std::vector<Spectrum> light_spectra(const Scene& scene, const std::vector<const Material*>& in_use) {
  Scene lights;
  for (const Material* material : in_use) lights.materials.emplace_back().exitance = material->exitance;
  lights.luminaires = scene.luminaires;
  lights.sun = scene.sun;
  lights.sky = scene.sky;
  std::vector<Spectrum> spectra;
  visit_lights(lights, [&](const Spectrum& spectrum, const SampledSpectrum*) {
    if ((spectrum != 0).any()) spectra.push_back(spectrum);
  });
  return spectra;
}

// The spectrum of which all are multiples, scaled to the largest value 1.
std::optional<Spectrum> common_colour(const std::vector<Spectrum>& spectra) {
  if (spectra.empty()) return std::nullopt;
  const Spectrum colour = spectra[0] / spectra[0].maxCoeff();
  for (const Spectrum& spectrum : spectra) {
    // Two quotients may differ by rounding.
    if (((spectrum / spectrum.maxCoeff() - colour).abs() > 4 * std::numeric_limits<double>::epsilon()).any())
      return std::nullopt;
  }
  return colour;
}

std::vector<Eigen::Index> bands_without_light(const std::vector<Spectrum>& spectra, Eigen::Index bands) {
  std::vector<Eigen::Index> dark;
  for (Eigen::Index band = 0; band < bands && !spectra.empty(); ++band) {
    if (std::all_of(spectra.begin(), spectra.end(), [&](const Spectrum& s) { return s[band] == 0; }))
      dark.push_back(band);
  }
  return dark;
}

// True when some kept side does not face the inside of a closed solid without openings.
bool some_side_sees_out(const Scene& scene, const KeptSides& kept) {
  const std::shared_ptr<const SceneGeometry> geometry = geometry_of(scene, kept);
  std::vector<Solid> sealed = geometry->solids;
  std::erase_if(sealed, [](const Solid& solid) { return solid.has_opening; });
  const std::vector<std::uint8_t> within = sides_within(scene, geometry->shells, sealed);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if ((kept.front[p] && !within[std::size_t{2} * p]) || (kept.back[p] && !within[std::size_t{2} * p + 1]))
      return true;
  }
  return false;
}

// Adds the facts about the pictures on kept sides.
EffectFacts with_texture_facts(EffectFacts facts, const Scene& scene, const KeptSides& kept) {
  std::vector<std::uint8_t> is_textured(scene.materials.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Polygon& polygon = scene.polygons[p];
    for (const Side side : {Side::front, Side::back})
      if (is_kept(kept, p, side) && texture_map_on(scene, polygon, side)) is_textured[material_on(polygon, side)] = 1;
  }
  for (std::size_t m = 0; m < is_textured.size(); ++m) {
    if (is_textured[m] == 0) continue;
    const TextureRange range = range_of(*scene.materials[m].texture);
    ++facts.textured;
    facts.texture_deviation = std::max(facts.texture_deviation, range.deviation);
    facts.highest_reflectance = std::max(facts.highest_reflectance, range.highest_reflectance);
    facts.grey = facts.grey && range.grey;
  }
  return facts;
}

// Panes reflect most at grazing angles: without a reflection there, they reflect nothing.
bool reflects(const Material& clear) {
  return (specular_reflectance(panes_of(clear.index, clear.transmittance), 0.1) > 0).any();
}

EffectFacts with_lights(EffectFacts facts, const Scene& scene, const KeptSides& kept) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto shines = [&](Side side) { return is_kept(kept, p, side) && emits(scene, p, side); };
    facts.lamps += shines(Side::front) || shines(Side::back);
    const MaterialIndex material = scene.polygons[p].material;
    const bool is_clear = is_opening(scene, p) && !scene.materials[material].second_face;
    facts.openings += is_clear;
    facts.reflecting += is_clear && is_reflecting_pane(scene, p);
    facts.sheets += is_sheet(scene, p);
    facts.mirrors += is_mirror(scene, p, Side::front) || is_mirror(scene, p, Side::back);
  }
  facts.luminaires = scene.luminaires.size();
  facts.sky = scene.sky.has_value();
  if (scene.sun) {
    const double sine = std::clamp(scene.sun->direction.dot(scene.up), -1.0, 1.0);
    facts.sun_altitude = std::asin(sine) * 180 / std::numbers::pi;
  }
  if (scene.sun || scene.sky) facts.sees_out = some_side_sees_out(scene, kept);
  return facts;
}

// The decision from the facts, unless the request overrules it.
Decision overruled(Decision by_facts, const Request& request) {
  const bool wanted = contains(request.effects.force, by_facts.effect) ||
                      (by_facts.simulate && !contains(request.effects.skip, by_facts.effect));
  by_facts.forced = wanted != by_facts.simulate;
  by_facts.simulate = wanted;
  return by_facts;
}

Decision occlusion(const EffectFacts& facts) {
  if (facts.inside_hull == 0) {
    return {Effect::occlusion, false, "all faces lie on one convex hull: nothing can stand between two patches",
            "no shadow ray between patches"};
  }
  return {
      Effect::occlusion, true,
      std::to_string(facts.inside_hull) + " of " + counted(facts.polygons, "face") + " can stand between two patches",
      "shadow rays, most of the time; none where nothing stands between two groups of patches"};
}

// Light of relative size rho^n is left after n bounces.
std::string bounces(double reflectance, double error) {
  if (reflectance >= 1) return "a reflectance of 1 sets no limit to the number of bounces";
  const double count = std::max(1.0, std::ceil(std::log(error) / std::log(reflectance)));
  return "after " + rounded(count) + " bounces at most " + rounded(error) + " of the light is left";
}

Decision interreflection(const EffectFacts& facts, const Request& request) {
  if (facts.highest_reflectance == 0) {
    return {Effect::interreflection, false, "all reflectances are 0: light is absorbed where it first arrives",
            "form factors of the lamps alone, and no equations"};
  }
  return {Effect::interreflection, true, "the highest reflectance is " + rounded(facts.highest_reflectance),
          bounces(facts.highest_reflectance, tolerance_of(request.solver))};
}

std::string numbers_of(const std::vector<Eigen::Index>& bands) {
  const auto number = [](Eigen::Index band) { return std::to_string(band + 1); };
  return (bands.size() == 1 ? "band " : "bands ") + listed_as(bands, number);
}

Decision colour(const EffectFacts& facts) {
  if (facts.bands == 1)
    return {Effect::colour, false, "the scene has one band", "nothing: one band is solved in any case"};
  const std::string all = std::to_string(facts.bands) + " bands";
  if (facts.grey && facts.lamp_colour) {
    return {Effect::colour, false, "no surface reflects one band better than another, and all lights have one color",
            "one band is solved instead of " + all};
  }
  const std::string dark = facts.dark_bands.empty() ? "" : "; " + numbers_of(facts.dark_bands) + " without light";
  const auto solved = static_cast<std::size_t>(facts.bands) - facts.dark_bands.size();
  return {Effect::colour, true,
          (facts.grey ? "lights differ in color" : "some surfaces reflect one band better than another") + dark,
          std::to_string(solved) + " of " + all + " are solved, together"};
}

// Up to three names with their places, as in "'attic' (house.obj:12)", or the first three of more without.
std::string first_names(const std::vector<DarkSolid>& solids) {
  const bool with_place = solids.size() <= 3;
  std::vector<std::string> names;
  for (const DarkSolid& solid : solids)
    names.push_back(with_place ? solid.name : solid.name.substr(0, solid.name.rfind(" (")));
  return first_few(names, 3);
}

// Nothing is left out of sides that are given.
std::optional<Decision> given_sides(Effect effect, const Request& request) {
  if (request.mesh.kept_sides) return Decision{effect, true, "the included sides are given", "unknown"};
  if (request.mesh.sides == Sides::automatic) return {};
  return Decision{effect, true, std::string("the included sides are given: mesh.sides=") + name_of(request.mesh.sides),
                  "unknown; mesh.sides=auto leaves out sides that no light reaches"};
}

Decision reach(const EffectFacts& facts, const Request& request) {
  if (const auto decision = given_sides(Effect::reach, request)) return *decision;
  if (facts.dark_solids.empty())
    return {Effect::reach, true, "no closed solid is without light inside", "no side is left out for it"};
  return {Effect::reach, false,
          "no light can get into " + counted(facts.dark_solids.size(), "closed solid") + ": " +
              first_names(facts.dark_solids),
          counted(facts.unreached, "side") + " of faces without patches"};
}

Decision backs(const EffectFacts& facts, const Request& request) {
  if (const auto decision = given_sides(Effect::backs, request)) return *decision;
  if (facts.turned_away == 0)
    return {Effect::backs, true, "no side is known to look into the dark", "no side is left out for it"};
  return {Effect::backs, false, "they face away from all light: out of the shell around the lamps, or towards nothing",
          counted(facts.turned_away, "side") + " of faces without patches"};
}

Decision luminaires(const EffectFacts& facts) {
  if (facts.luminaires == 0) return {Effect::luminaires, false, "the scene has none", "no rays towards them"};
  return {Effect::luminaires, true, "the scene has " + std::to_string(facts.luminaires),
          std::to_string(facts.luminaires) + " times 64 shadow rays per patch"};
}

// Light from outside arrives only where something sees out.
Decision daylight(Effect effect, const EffectFacts& facts, const char* rays) {
  if (facts.openings == 0 && !facts.sees_out)
    return {effect, false, "no face is clear, and no side sees out of the closed solids", "no rays towards it"};
  return {effect, true,
          facts.openings > 0 ? counted(facts.openings, "clear face") + " let it in" : "some sides see out", rays};
}

Decision sun(const EffectFacts& facts) {
  if (!facts.sun_altitude) return {Effect::sun, false, "the scene has none", "no rays towards it"};
  if (*facts.sun_altitude > 0) return daylight(Effect::sun, facts, "64 shadow rays per patch");
  return {Effect::sun, false, "it is " + rounded(-*facts.sun_altitude) + " degrees below the horizon",
          "no rays towards it"};
}

Decision sky(const EffectFacts& facts) {
  if (!facts.sky) return {Effect::sky, false, "the scene has none", "no rays towards it"};
  return daylight(Effect::sky, facts, "1024 shadow rays per patch");
}

// Follows the decision about interreflection.
Decision closure(const Request& request, bool interreflects) {
  Decision decision{Effect::closure, true, "light is reflected more than once: errors of row sums would add up",
                    "a few products with the matrix"};
  if (request.assembly.storage == Storage::rays) return closed_by_rays();
  if (!keeps_entries(request.assembly.storage))
    return {Effect::closure, false, "rows on demand cannot be closed", "the matrix"};
  if (!interreflects)
    decision = {Effect::closure, false, "no light is reflected twice: no error of row sums adds up", "the matrix"};
  Request asked = request;
  if (!request.assembly.close) asked.effects.skip.push_back(Effect::closure);
  return overruled(std::move(decision), asked);
}

Decision textures(const EffectFacts& facts) {
  if (facts.textured == 0)
    return {Effect::textures, false, "no material has a texture with known coordinates on a face", "nothing"};
  return {Effect::textures, true,
          std::to_string(facts.textured) + " of " + counted(facts.materials, "material") +
              (facts.textured == 1 ? " has a texture" : " have textures") +
              "; texels differ from the mean of their texture by up to " + rounded(100 * facts.texture_deviation) +
              " %, rms",
          "the mean of a texture over each patch"};
}

std::string counted_specular(const EffectFacts& facts) {
  std::string list;
  if (facts.mirrors > 0) list = counted(facts.mirrors, "mirror");
  if (facts.reflecting > 0) list += (list.empty() ? "" : " and ") + counted(facts.reflecting, "clear face");
  return list;
}

// Shadow rays between pairs of patches do not see by way of mirrors.
Decision mirrors(const EffectFacts& facts, const Request& request) {
  if (!has_reflections(facts))
    return {Effect::mirrors, false, "no face reflects light without scattering it", "rays that continue from mirrors"};
  const std::string what = counted_specular(facts);
  if (request.assembly.storage != Storage::rays)
    return {Effect::mirrors, false,
            "the pair method does not follow light over mirrors (" + what +
                "): light that these reflect counts as absorbed; assembly.storage=rays follows it",
            "rows of rays instead of pairs"};
  return overruled({Effect::mirrors, true, "light is reflected without being scattered, by " + what,
                    "one more ray for each reflection of a ray"},
                   request);
}

// Effects for which users cannot decide.
std::vector<Decision> undecidable(const EffectFacts& facts) {
  std::vector<Decision> decisions;
  const auto add = [&](Effect effect, std::size_t count, const std::string& reason) {
    if (count > 0) decisions.push_back({effect, false, "not simulated: " + reason, "nothing: the result lacks it"});
  };
  if (facts.coloured_specular > 0)
    decisions.push_back({Effect::bands_of_panes, true,
                         "colors of " + counted(facts.coloured_specular, "clear or mirroring material") +
                             " change light between patches",
                         "form factors and a solution for each of these colors, from the same rays"});
  add(Effect::gloss, facts.gloss, counted(facts.gloss, "material") + " with gloss or metal, simulated as matte");
  add(Effect::glass, facts.glass, counted(facts.glass, "transparent material") + ", simulated as opaque");
  return decisions;
}

// An effect that the scene does not have can neither be forced nor skipped.
bool is_there(Effect effect, const EffectFacts& facts) {
  switch (effect) {
    case Effect::luminaires:
      return facts.luminaires > 0;
    case Effect::sun:
      return facts.sun_altitude && *facts.sun_altitude > 0;
    case Effect::sky:
      return facts.sky;
    case Effect::colour:
      return facts.bands > 1;
    case Effect::reach:
      return !facts.dark_solids.empty();
    case Effect::backs:
      return facts.turned_away > 0;
    case Effect::textures:
      return facts.textured > 0;
    case Effect::mirrors:
      return has_reflections(facts);
    default:
      return true;
  }
}

const char* word_for(const Decision& decision) {
  if (decision.forced) return decision.simulate ? "enabled by option" : "disabled by option";
  return decision.simulate ? "simulated" : "left out";
}

}  // namespace

bool is_reflecting_pane(const Scene& scene, PolygonIndex polygon) {
  const Polygon& face = scene.polygons[polygon];
  return is_opening(scene, polygon) && (reflects(scene.materials[material_on(face, Side::front)]) ||
                                        reflects(scene.materials[material_on(face, Side::back)]));
}

std::size_t coloured_specular(const Scene& scene, const KeptSides& kept) {
  const std::vector<const Material*> in_use = materials_in_use(scene, kept);
  return static_cast<std::size_t>(
      std::count_if(in_use.begin(), in_use.end(), [](const Material* m) { return !has_grey_passage(*m); }));
}

EffectFacts survey_effects(const Scene& scene, const KeptSides& kept) {
  EffectFacts facts;
  facts.polygons = scene.polygons.size();
  const std::vector<std::uint8_t> on_hull = on_convex_hull(scene);
  facts.inside_hull = static_cast<std::size_t>(std::count(on_hull.begin(), on_hull.end(), std::uint8_t{0}));

  const std::vector<const Material*> in_use = materials_in_use(scene, kept);
  for (const Material* material : in_use)
    facts.highest_reflectance = std::max(facts.highest_reflectance, highest_scattered(*material));
  facts.bands = number_of_bands(scene);
  facts.band_choice = scene.band_choice;
  facts.grey = is_grey(scene, in_use);
  facts.coloured_specular = coloured_specular(scene, kept);
  const std::vector<Spectrum> spectra = light_spectra(scene, in_use);
  facts.lamp_colour = common_colour(spectra);
  facts.dark_bands = bands_without_light(spectra, facts.bands);

  facts.materials = in_use.size();
  facts = with_texture_facts(std::move(facts), scene, kept);

  facts.dark_solids = kept.dark_solids;
  facts.unreached = kept.unreached;
  facts.turned_away = kept.turned_away;
  facts = with_lights(std::move(facts), scene, kept);
  for (const UnsimulatedMaterials& found : scene.unsimulated)
    (found.property == UnsimulatedProperty::mirror ? facts.gloss : facts.glass) += found.materials;
  return facts;
}

Decision closed_by_rays() {
  return {Effect::closure, false, "each row of rays is closed by itself", "products with the matrix"};
}

std::vector<Decision> decide(const EffectFacts& facts, const Request& request) {
  std::vector<Decision> decisions = {occlusion(facts),
                                     interreflection(facts, request),
                                     colour(facts),
                                     reach(facts, request),
                                     backs(facts, request),
                                     luminaires(facts),
                                     sun(facts),
                                     sky(facts),
                                     textures(facts)};
  for (Decision& decision : decisions) {
    if (is_there(decision.effect, facts)) decision = overruled(std::move(decision), request);
  }
  decisions.push_back(mirrors(facts, request));
  decisions.push_back(closure(request, decisions[1].simulate));
  if (facts.band_choice) {
    decisions.push_back(
        {Effect::spectra, facts.band_choice->spectral, facts.band_choice->reason, facts.band_choice->saving});
  }
  for (Decision& decision : undecidable(facts)) decisions.push_back(std::move(decision));
  return decisions;
}

Diagnostics notes_on_overruling(const EffectFacts& facts, const Request& request) {
  Diagnostics notes;
  const auto add = [&](const std::string& field, const std::vector<Effect>& effects) {
    for (const Effect effect : effects) {
      if (!is_there(effect, facts))
        notes.push_back({DiagnosticCode::idle_option,
                         field + "=" + name_of(effect) + " changes nothing: the scene does not have this effect"});
    }
  };
  add("effects.force", request.effects.force);
  add("effects.skip", request.effects.skip);
  return notes;
}

std::vector<Effect> simulated_effects() {
  return {Effect::occlusion, Effect::interreflection, Effect::colour, Effect::reach,
          Effect::backs,     Effect::luminaires,      Effect::sun,    Effect::sky,
          Effect::textures,  Effect::mirrors,         Effect::closure};
}

const char* name_of(Effect effect) {
  constexpr std::array names = {
      "occlusion", "interreflection", "color",   "reach",          "backs",   "luminaires", "sun",  "sky",
      "textures",  "mirrors",         "closure", "color of panes", "spectra", "gloss",      "glass"};
  return names.at(static_cast<std::size_t>(effect));
}

bool contains(const std::vector<Effect>& effects, Effect effect) {
  return std::find(effects.begin(), effects.end(), effect) != effects.end();
}

std::string sentence(const Decision& decision) {
  return std::string(name_of(decision.effect)) + ": " + word_for(decision) + "; " + decision.reason;
}

}  // namespace patchlight
