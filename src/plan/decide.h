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
  double highest_reflectance = 0;  ///< of the kept sides, worst band, with the transmission of sheets
  Eigen::Index bands = 0;
  bool grey = false;  ///< reflectances and transmittances are the same in all bands
  /// The common spectrum of all lights, relative to its brightest band; nothing where they differ.
  std::optional<Spectrum> lamp_colour;
  std::vector<Eigen::Index> dark_bands;  ///< bands without light; empty when there is no light at all
  std::vector<DarkSolid> dark_solids;
  std::size_t unreached = 0;    ///< sides that face the inside of a dark solid
  std::size_t turned_away = 0;  ///< sides that look into the dark outside of a closed solid
  std::size_t lamps = 0;        ///< polygons that emit
  std::size_t luminaires = 0;
  std::optional<double> sun_altitude;  ///< degrees above the horizon; nothing without a sun
  bool sky = false;
  std::size_t openings = 0;           ///< clear faces; a solid pane counts once
  std::size_t reflecting = 0;         ///< of the openings, those that reflect: their refractive index is not 1
  bool sees_out = true;               ///< some kept side faces something else than the inside of a closed solid
  std::size_t sheets = 0;             ///< translucent polygons
  std::size_t mirrors = 0;            ///< polygons with a mirror on at least one side
  std::size_t coloured_specular = 0;  ///< materials whose transmittance or specular reflectance differs by band
  std::size_t textured = 0;           ///< materials of kept sides that have textures there
  double texture_deviation = 0;       ///< TextureRange::deviation, the largest of these
  std::size_t materials = 0;          ///< of kept sides
  std::size_t gloss = 0;              ///< materials that are partly mirrors in the file
  std::optional<BandChoice> band_choice = {};  ///< Scene::band_choice
  std::size_t glass = 0;                       ///< materials that are transparent in the file; simulated as opaque
};

/// True when the side is kept.
inline bool is_kept(const KeptSides& kept, PolygonIndex polygon, Side side) {
  return (side == Side::front ? kept.front : kept.back)[polygon] != 0;
}

/// The number of materials of kept sides whose transmittance or specular reflectance differs between bands.
std::size_t coloured_specular(const Scene& scene, const KeptSides& kept);

/// True for a clear face that reflects light: its refractive index is not 1.
bool is_reflecting_pane(const Scene& scene, PolygonIndex polygon);

/// True when some face reflects light without scattering it.
inline bool has_reflections(const EffectFacts& facts) { return facts.mirrors > 0 || facts.reflecting > 0; }

/// Collects the facts of a scene with these kept sides. Pure. O(n log n) for n corners, plus the cost of
/// on_convex_hull().
EffectFacts survey_effects(const Scene& scene, const KeptSides& kept);

/// Decides which effects are simulated, from the facts of the scene and the request. Returns one decision for each of
/// simulated_effects(), and one for each effect of the scene that patchlight cannot simulate. EffectOptions::force and
/// EffectOptions::skip overrule the facts. An effect that the scene lacks cannot be forced. Pure.
std::vector<Decision> decide(const EffectFacts& facts, const Request& request);

/// The decision about closure where form factors are rows of rays.
Decision closed_by_rays();

/// A note on every forced or skipped effect that the scene does not have.
Diagnostics notes_on_overruling(const EffectFacts& facts, const Request& request);

}  // namespace patchlight
