#include "input/mitsuba_emitters.h"

#include "patchlight/base/error.h"

#include "base/rounded.h"
#include "input/mitsuba_spectrum.h"

#include <cmath>
#include <numbers>
#include <optional>

namespace patchlight {
namespace {

Spectrum strength(const MitsubaFile& file, const pugi::xml_node& emitter, const std::string& name) {
  const std::optional<MitsubaColour> found = mitsuba_colour(file, file.property(emitter, name));
  return (found ? found->value : rgb(1, 1, 1)) * file.number(emitter, "scale", 1);
}

Vector turned(const Eigen::Matrix4d& matrix, const Vector& direction) {
  return (matrix.topLeftCorner<3, 3>() * direction).stableNormalized();
}

Point placed_at(const Eigen::Matrix4d& matrix, const Point& point) { return (matrix * point.homogeneous()).head<3>(); }

Scene with_point(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter) {
  Luminaire luminaire;
  const std::string id = file.text(emitter, "id");
  luminaire.name = id.empty() ? "point light" : id;
  luminaire.place = file.place(emitter);
  luminaire.position =
      scene.metres_per_unit * placed_at(file.to_world(emitter), file.vector(emitter, "position", Vector::Zero()));
  luminaire.light = PointLight{strength(file, emitter, "intensity") * std::pow(scene.metres_per_unit, 2)};
  scene.luminaires.push_back(std::move(luminaire));
  return scene;
}

// The intensity on the axis holds up to the beam width and falls linearly to 0 at the cutoff angle. The profile of a
// spot has the same half width; its field makes the flux the same within 7 %.
Scene with_spot(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter) {
  const double cutoff = file.number(emitter, "cutoffangle", 20);
  const double beam = file.number(emitter, "beamwidth", 0.75 * cutoff);
  if (!(0 <= beam && beam < cutoff && cutoff <= 90))
    throw InputError(file.place(emitter), "found a spot with a beam width of " + rounded(beam) +
                                              " and a cutoff angle of " + rounded(cutoff) +
                                              " degrees; expected 0 <= beam width < cutoff angle <= 90");
  Luminaire luminaire;
  const std::string id = file.text(emitter, "id");
  luminaire.name = id.empty() ? "spot light" : id;
  luminaire.place = file.place(emitter);
  const Eigen::Matrix4d matrix = file.to_world(emitter);
  luminaire.position = scene.metres_per_unit * placed_at(matrix, Point::Zero());
  luminaire.aim = turned(matrix, Vector::UnitZ());
  if (!(luminaire.aim.norm() > 0.5)) throw InputError(file.place(emitter), "the spot emitter has no direction");
  luminaire.zero_plane = luminaire.aim.unitOrthogonal();
  // A linear fall is at one half in the middle and at one tenth nine tenths of the way.
  luminaire.light = SpotLight{strength(file, emitter, "intensity") * std::pow(scene.metres_per_unit, 2),
                              beam + 0.5 * (cutoff - beam), beam + 0.9 * (cutoff - beam)};
  scene.luminaires.push_back(std::move(luminaire));
  return scene;
}

Scene with_directional(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter) {
  const Vector stated = file.vector(emitter, "direction", Vector::UnitZ());
  const Vector way = turned(file.to_world(emitter), stated);
  if (!(way.norm() > 0.5)) throw InputError(file.place(emitter), "the directional emitter has no direction");
  scene.sun = Sun{-way, strength(file, emitter, "irradiance")};
  return scene;
}

}  // namespace

Scene with_mitsuba_emitter(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter) {
  const std::string kind = file.text(emitter, "type");
  if (kind == "point") return with_point(std::move(scene), file, emitter);
  if (kind == "spot") return with_spot(std::move(scene), file, emitter);
  if (kind == "directional" && !scene.sun) return with_directional(std::move(scene), file, emitter);
  if (kind == "constant" && !scene.sky) {
    const Spectrum radiance = strength(file, emitter, "radiance");
    scene.sky = Sky{.zenith_radiance = radiance, .ground_radiance = radiance};
    return scene;
  }
  const bool is_sky = kind == "envmap" || kind == "sky" || kind == "sunsky" || kind == "sun" || kind == "constant";
  const char* const remedy =
      is_sky ? ": give the scene a sky by --sky, e.g. --sky overcast:10000lx, a sun by --sun" : "";
  scene.problems.push_back(
      {ProblemKind::left_out, 1, "the emitter " + kind + " (" + file.place(emitter) + ") is left out" + remedy, {}});
  return scene;
}

Scene with_mitsuba_sensor(Scene scene, const MitsubaFile& file, const pugi::xml_node& sensor) {
  if (file.text(sensor, "type") != "perspective" && file.text(sensor, "type") != "thinlens") return scene;
  const Eigen::Matrix4d matrix = file.to_world(sensor);
  const Point eye = scene.metres_per_unit * placed_at(matrix, Point::Zero());
  const Vector way = turned(matrix, Vector::UnitZ());
  const pugi::xml_node film = file.nested(sensor, "film");
  const double aspect = file.number(film, "height", 576) / file.number(film, "width", 768);
  const double stated = std::tan(file.number(sensor, "fov", 50) * std::numbers::pi / 360);
  // The angle is that across, unless it is said to be another one.
  const std::string axis = file.word(sensor, "fovaxis", "x");
  const bool is_vertical = axis == "y" || (axis == "smaller" && aspect < 1) || (axis == "larger" && aspect > 1);
  const double angle = 360 / std::numbers::pi * std::atan(is_vertical ? stated : stated * aspect);
  if (!(way.norm() > 0.5) || !(angle > 0 && angle < 180)) return scene;
  const std::string id = file.text(sensor, "id");
  scene.cameras.push_back({eye, eye + way, angle, id.empty() ? "sensor" : id});
  return scene;
}

Spectrum emitted_radiance(const MitsubaFile& file, const pugi::xml_node& shape) {
  pugi::xml_node emitter = file.nested(shape, "emitter");
  if (!emitter) emitter = file.nested(shape, "luminaire");
  if (!emitter || file.text(emitter, "type") != "area") return rgb(0, 0, 0);
  return strength(file, emitter, "radiance");
}

}  // namespace patchlight
