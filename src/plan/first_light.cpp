#include "plan/first_light.h"

#include "base/near_match.h"
#include "plan/first_few.h"
#include "plan/lamp_names.h"
#include "scene/room_body.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <vector>

namespace patchlight {
namespace {

// A radiance to begin with where the model names none: 1,800 cd/m^2, a lit panel. W/(m^2 sr).
constexpr double usual_radiance = 10;

constexpr std::size_t most_hints = 3;

constexpr const char* usual_sky = "read.daylight.sky=overcast:10000lx";

// The reader's hints, else the materials with a name like a lamp's.
std::vector<LampHint> possible_lamps(const Scene& scene) {
  if (!scene.lamp_hints.empty()) return scene.lamp_hints;
  std::vector<LampHint> hints;
  for (const Material& material : scene.materials) {
    if (is_name_of_lamp(material.name))
      hints.push_back({material.name, Spectrum::Constant(1, usual_radiance), "its name"});
  }
  return hints;
}

// As one types it in a shell.
std::string setting_for(const LampHint& hint) {
  std::ostringstream text;
  text << hint.material << ".radiance=" << hint.radiance.format(Eigen::IOFormat(6, Eigen::DontAlignCols, ","));
  return "read.settings " + shell_word(text.str());
}

std::string advice_on_lamps(const std::vector<LampHint>& hints) {
  std::string advice;
  for (std::size_t k = 0; k < std::min(most_hints, hints.size()); ++k) {
    advice +=
        "\nhint: '" + hints[k].material + "' looks like a lamp (" + hints[k].reason + "): " + setting_for(hints[k]);
  }
  return advice;
}

std::string advice_on_other_light(const Scene& scene, const std::optional<Solid>& hull) {
  if (hull && is_room(scene, *hull)) {
    return "\nhint: the room has no window (" + place_of(scene, scene.polygons[hull->polygons.front()]) +
           "); create a scene with a lamp: patchlight init MODEL -o SCENE.toml";
  }
  return std::string("\nhint: add daylight") + (hull ? " from outside: " : ": ") + usual_sky +
         "\nhint: create a scene with lamps or daylight: patchlight init MODEL -o SCENE.toml";
}

}  // namespace

FirstLight first_light(const Scene& scene) {
  const std::optional<Solid> hull = sealed_hull(scene);
  const std::vector<LampHint> hints = possible_lamps(scene);
  FirstLight light;
  light.advice = "no material emits" + advice_on_lamps(hints) + advice_on_other_light(scene, hull);
  const bool is_sealed = hull && is_room(scene, *hull);
  if (!is_sealed) light.setting = usual_sky;
  if (is_sealed && !hints.empty()) light.setting = setting_for(hints.front());
  if (!hints.empty()) return light;
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  light.advice += "\nhint: make a material emit, one of " + first_few(names) + ": read.settings MATERIAL.radiance=10";
  return light;
}

}  // namespace patchlight
