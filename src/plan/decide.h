#pragma once

#include "patchlight/plan/effects.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace patchlight {

/// The facts of a scene that decide which effects are simulated.
struct EffectFacts {
  std::size_t polygons = 0;
  std::size_t inside_hull = 0;     ///< polygons that can stand between two others
  double highest_reflectance = 0;  ///< of the kept sides, worst band, with what sheets scatter to their other side
  Eigen::Index bands = 0;
  bool grey = false;                     ///< reflectances and transmittances are the same in all bands
  std::optional<Spectrum> lamp_colour;   ///< the spectrum of which all lights are multiples, relative to its brightest
                                         ///< band; nothing where there is none
  std::vector<Eigen::Index> dark_bands;  ///< in which nothing gives light; empty when there is no light at all
  std::vector<DarkSolid> dark_solids;
  std::size_t unreached = 0;    ///< sides that face the inside of one
  std::size_t turned_away = 0;  ///< sides that look into the dark outside of a closed solid
  std::size_t lamps = 0;        ///< polygons that emit
  std::size_t luminaires = 0;
  std::optional<double> sun_altitude;  ///< degrees above the horizon; nothing where there is no sun
  bool sky = false;
  std::size_t openings = 0;           ///< clear faces, of a solid pane one
  std::size_t reflecting = 0;         ///< of these, those that reflect, as nothing with the index 1 does
  bool sees_out = true;               ///< some kept side does not face the inside of a closed solid
  std::size_t sheets = 0;             ///< translucent polygons
  std::size_t mirrors = 0;            ///< polygons of which a side is a mirror
  std::size_t coloured_specular = 0;  ///< materials whose transmittance or specular reflectance differs by band
  std::size_t textured = 0;           ///< materials of kept sides that have pictures there
  double texture_deviation = 0;       ///< TextureRange::deviation, the largest of these
  std::size_t materials = 0;          ///< of kept sides
  std::size_t gloss = 0;              ///< materials that a file says are partly mirrors
  std::optional<BandChoice> band_choice = {};  ///< Scene::band_choice
  std::size_t glass = 0;                       ///< materials that a file says are transparent, taken for opaque
};

/// True when the side is kept.
inline bool is_kept(const KeptSides& kept, PolygonIndex polygon, Side side) {
  return (side == Side::front ? kept.front : kept.back)[polygon] != 0;
}

/// How many materials of kept sides have a transmittance or specular reflectance that differs between bands.
std::size_t coloured_specular(const Scene& scene, const KeptSides& kept);

/// True for a clear face that reflects light: its index is not 1.
bool is_reflecting_pane(const Scene& scene, PolygonIndex polygon);

/// True when some face reflects light without scattering it.
inline bool has_reflections(const EffectFacts& facts) { return facts.mirrors > 0 || facts.reflecting > 0; }

/// Looks at a scene of which these sides are kept. Pure. O(n log n) for n corners, and what on_convex_hull() takes.
EffectFacts survey_effects(const Scene& scene, const KeptSides& kept);

/// Which effects are simulated, given what the scene is like and what is asked for: one decision for each of
/// simulated_effects(), and one for each effect that is not simulated and that the scene has. Pure.
/// EffectOptions::force and EffectOptions::skip overrule the facts, as long as there is something to simulate: a sun
/// that is not there cannot be forced.
std::vector<Decision> decide(const EffectFacts& facts, const Request& request);

/// The decision about closure where form factors are rows of rays.
Decision closed_by_rays();

/// A note on every effect that is to be forced or skipped and of which the scene has nothing.
Diagnostics notes_on_overruling(const EffectFacts& facts, const Request& request);

}  // namespace patchlight
