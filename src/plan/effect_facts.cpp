#include "plan/effect_facts.h"

#include "light/texture.h"
#include "scene/solids.h"
#include "scene/specular_faces.h"
#include "visibility/flat_polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

namespace patchlight {
namespace {

// The materials of kept sides, each once.
std::vector<const Material*> materials_in_use(const Scene& scene, const KeptSides& kept) {
  std::vector<std::uint8_t> used(scene.materials.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (kept.front[p]) used[material_on(scene.polygons[p], Side::front)] = 1;
    if (kept.back[p]) used[material_on(scene.polygons[p], Side::back)] = 1;
  }
  std::vector<const Material*> materials;
  for (std::size_t m = 0; m < used.size(); ++m) {
    if (used[m]) materials.push_back(&scene.materials[m]);
  }
  return materials;
}

bool is_constant(const Spectrum& spectrum) { return spectrum.size() == 0 || (spectrum == spectrum[0]).all(); }

// What goes through or is mirrored keeps its colour.
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

// A place behind which there is no light stays as it is: transmittances of faces that take no part colour daylight,
// too.
bool is_grey(const Scene& scene, const std::vector<const Material*>& in_use) {
  return std::all_of(in_use.begin(), in_use.end(), [](const Material* m) { return is_grey(*m); }) &&
         std::all_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return has_grey_passage(m); });
}

const Spectrum& spectrum_of(const Luminaire& luminaire) {
  return std::visit(
      [](const auto& light) -> const Spectrum& {
        using Light = std::decay_t<decltype(light)>;
        if constexpr (std::is_same_v<Light, WebLight>) {
          return light.watts_per_lumen;
        } else if constexpr (std::is_same_v<Light, SphericalLamp>) {
          return light.exitance;
        } else {
          return light.intensity;
        }
      },
      luminaire.light);
}

// The spectra of all that gives light.
std::vector<Spectrum> light_spectra(const Scene& scene, const std::vector<const Material*>& in_use) {
  std::vector<Spectrum> spectra;
  for (const Material* material : in_use) spectra.push_back(material->exitance);
  for (const Luminaire& luminaire : scene.luminaires) spectra.push_back(spectrum_of(luminaire));
  if (scene.sun) spectra.push_back(scene.sun->normal_irradiance);
  if (scene.sky) {
    for (const Spectrum* s :
         {&scene.sky->horizontal_irradiance, &scene.sky->zenith_radiance, &scene.sky->ground_radiance}) {
      spectra.push_back(*s);
    }
  }
  std::erase_if(spectra, [](const Spectrum& spectrum) { return spectrum.size() == 0 || (spectrum == 0).all(); });
  return spectra;
}

// The one of which all are multiples, its largest value 1.
std::optional<Spectrum> common_colour(const std::vector<Spectrum>& spectra) {
  if (spectra.empty()) return std::nullopt;
  // Rounding of two quotients.
  constexpr double tolerance = 4 * std::numeric_limits<double>::epsilon();
  const Spectrum colour = spectra[0] / spectra[0].maxCoeff();
  for (const Spectrum& spectrum : spectra) {
    if (((spectrum / spectrum.maxCoeff() - colour).abs() > tolerance).any()) return std::nullopt;
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
  const Shells shells = shells_of(scene);
  std::vector<Solid> sealed = closed_solids(scene, shells);
  std::erase_if(sealed, [](const Solid& solid) { return solid.has_opening; });
  const std::vector<std::uint8_t> within = sides_within(scene, shells, sealed);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if ((kept.front[p] && !within[std::size_t{2} * p]) || (kept.back[p] && !within[std::size_t{2} * p + 1]))
      return true;
  }
  return false;
}

// What the pictures on kept sides are like.
EffectFacts with_texture_facts(EffectFacts facts, const Scene& scene, const KeptSides& kept) {
  std::vector<std::uint8_t> is_textured(scene.materials.size(), 0);
  for (const Polygon& polygon : scene.polygons) {
    const auto p = static_cast<std::size_t>(&polygon - scene.polygons.data());
    for (const Side side : {Side::front, Side::back}) {
      const bool takes_part = (side == Side::front ? kept.front : kept.back)[p] != 0;
      if (takes_part && texture_map_on(scene, polygon, side)) is_textured[material_on(polygon, side)] = 1;
    }
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

// What reflects nothing at a narrow angle, where it would most, reflects nothing at all.
bool reflects(const Material& clear) {
  constexpr double grazing_cosine = 0.1;
  const std::vector<Pane> panes = panes_of(clear);
  return std::any_of(panes.begin(), panes.end(),
                     [](const Pane& pane) { return specular_reflectance(pane, grazing_cosine) > 0; });
}

EffectFacts with_lights(EffectFacts facts, const Scene& scene, const KeptSides& kept) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    facts.lamps += (kept.front[p] && emits(scene, p, Side::front)) || (kept.back[p] && emits(scene, p, Side::back));
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

}  // namespace patchlight
