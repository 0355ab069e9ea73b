#include "plan/decide.h"

#include "scene/model_face.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// The decision that the facts call for, or the one that the request asks for instead.
Decision overruled(Decision by_facts, const Request& request) {
  const bool wanted = contains(request.effects.force, by_facts.effect) ||
                      (by_facts.simulate && !contains(request.effects.skip, by_facts.effect));
  by_facts.forced = wanted != by_facts.simulate;
  by_facts.simulate = wanted;
  return by_facts;
}

std::string number(double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  return text.str();
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
  return "after " + number(count) + " bounces at most " + number(error) + " of the light is left";
}

Decision interreflection(const EffectFacts& facts, const Request& request) {
  if (facts.highest_reflectance == 0) {
    return {Effect::interreflection, false, "all reflectances are 0: light is absorbed where it first arrives",
            "form factors of the lamps alone, and no equations"};
  }
  return {Effect::interreflection, true, "the highest reflectance is " + number(facts.highest_reflectance),
          bounces(facts.highest_reflectance, tolerance_of(request.solver))};
}

std::string numbers_of(const std::vector<Eigen::Index>& bands) {
  std::string list;
  for (const Eigen::Index band : bands) list += (list.empty() ? "" : ", ") + std::to_string(band + 1);
  return (bands.size() == 1 ? "band " : "bands ") + list;
}

Decision colour(const EffectFacts& facts) {
  if (facts.bands == 1)
    return {Effect::colour, false, "the scene has one band", "nothing: one band is solved in any case"};
  const std::string all = std::to_string(facts.bands) + " bands";
  if (facts.grey && facts.lamp_colour) {
    return {Effect::colour, false, "no surface reflects one band better than another, and all lights have one colour",
            "one band is solved instead of " + all};
  }
  const std::string dark = facts.dark_bands.empty() ? "" : "; " + numbers_of(facts.dark_bands) + " without light";
  const auto solved = static_cast<std::size_t>(facts.bands) - facts.dark_bands.size();
  return {Effect::colour, true,
          (facts.grey ? "lights differ in colour" : "some surfaces reflect one band better than another") + dark,
          std::to_string(solved) + " of " + all + " are solved, together"};
}

std::string first_names(const std::vector<DarkSolid>& solids) {
  constexpr std::size_t few = 3;
  std::string list;
  const bool with_place = solids.size() <= few;  // "'attic' (house.obj:12)"
  for (std::size_t k = 0; k < std::min(few, solids.size()); ++k) {
    const std::string& name = solids[k].name;
    list += (k > 0 ? ", " : "") + (with_place ? name : name.substr(0, name.rfind(" (")));
  }
  return solids.size() > few ? list + " and " + std::to_string(solids.size() - few) + " more" : list;
}

// Nothing is left out of sides that are given.
std::optional<Decision> given_sides(Effect effect, const Request& request) {
  if (request.mesh.kept_sides) return Decision{effect, true, "the sides that take part are given", "unknown"};
  if (request.mesh.sides == Sides::automatic) return {};
  return Decision{effect, true,
                  std::string("the sides that take part are given: mesh.sides=") + name_of(request.mesh.sides),
                  "unknown; with mesh.sides=auto the plan leaves out what no light reaches"};
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
  return {Effect::backs, false,
          "they look away from all light: out of what encloses the lamps, or nothing is before them",
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
  return {Effect::sun, false, "it is " + number(-*facts.sun_altitude) + " degrees below the horizon",
          "no rays towards it"};
}

Decision sky(const EffectFacts& facts) {
  if (!facts.sky) return {Effect::sky, false, "the scene has none", "no rays towards it"};
  return daylight(Effect::sky, facts, "1024 shadow rays per patch");
}

// By what is decided about interreflection.
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
    return {Effect::textures, false, "no material has a picture whose place on a face is known", "nothing"};
  return {Effect::textures, true,
          std::to_string(facts.textured) + " of " + counted(facts.materials, "material") +
              (facts.textured == 1 ? " has a picture" : " have pictures") +
              "; texels differ from the mean of their picture by up to " + number(100 * facts.texture_deviation) +
              " %, rms",
          "the mean of a picture over each patch"};
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
    return {Effect::mirrors, false, "no face reflects light without scattering it", "rays that go on from mirrors"};
  const std::string what = counted_specular(facts);
  if (request.assembly.storage != Storage::rays)
    return {Effect::mirrors, false,
            "form factors of pairs do not see by way of mirrors (" + what +
                "): light that these reflect counts as absorbed; assembly.storage=rays follows it",
            "rows of rays instead of pairs"};
  return overruled({Effect::mirrors, true, "light is reflected without being scattered, by " + what,
                    "a ray more for each time that a ray is reflected"},
                   request);
}

// Effects for which users cannot decide.
std::vector<Decision> undecidable(const EffectFacts& facts) {
  std::vector<Decision> decisions;
  const auto add = [&](Effect effect, std::size_t count, const std::string& reason) {
    if (count > 0) decisions.push_back({effect, false, "not simulated: " + reason, "nothing: the answer lacks it"});
  };
  if (facts.coloured_specular > 0)
    decisions.push_back({Effect::bands_of_panes, true,
                         "colours of " + counted(facts.coloured_specular, "clear or mirroring material") +
                             " change light between patches",
                         "form factors and a solution for each of these colours, from the same rays"});
  add(Effect::gloss, facts.gloss, counted(facts.gloss, "material") + " with gloss or metal, taken for matt");
  add(Effect::glass, facts.glass, counted(facts.glass, "transparent material") + ", taken for opaque");
  return decisions;
}

// An effect of which the scene has nothing can neither be forced nor skipped.
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

}  // namespace

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
                         field + "=" + name_of(effect) + " changes nothing: the scene has nothing of it"});
    }
  };
  add("effects.force", request.effects.force);
  add("effects.skip", request.effects.skip);
  return notes;
}

}  // namespace patchlight
