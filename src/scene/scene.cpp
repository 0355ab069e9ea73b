#include "patchlight/scene/scene.h"

#include "patchlight/base/error.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "light/texture.h"
#include "scene/model_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// Exchange areas are kept as floats: those of the small patches of a smaller model would be below the smallest. Meters.
constexpr double shortest_model = 1e-12;

// The checks of a polygon's outline take a time that goes as the square of this: a second for so many.
constexpr std::size_t most_corners = 10000;

void check_bands(const Scene& scene) {
  if (scene.bands.empty()) return;
  const auto number = static_cast<std::size_t>(number_of_bands(scene));
  if (scene.bands.size() == number) return;
  throw InputError(scene.file, "the scene defines " + std::to_string(scene.bands.size()) +
                                   " bands, and its materials have " + std::to_string(number) +
                                   "; expected the same number");
}

// Refuses a material for a finding, which ends with a hint, and names the setting that changes it.
[[noreturn]] void refuse(const Scene& scene, const Material& material, const std::string& finding,
                         const std::string& setting) {
  throw InputError(
      scene.file, "material '" + material.name + "' has " + finding + "read.settings " + material.name + "." + setting);
}

// A share of light beside the reflectance, in each band.
void check_share(const Scene& scene, const Material& material, const Spectrum& values, const std::string& quantity) {
  for (Eigen::Index band = 0; band < values.size(); ++band) {
    if (values[band] >= 0 && values[band] + material.reflectance[band] <= 1) continue;
    refuse(scene, material,
           quantity + " " + shortest(values[band]) + " and reflectance " + shortest(material.reflectance[band]) +
               "; expected numbers not below 0 whose sum is at most 1\nhint: ",
           "reflectance=R,G,B");
  }
}

// A mirror that lets light through would be a pane: its reflection follows from its index.
void check_specular_reflectance(const Scene& scene, const Material& material) {
  check_share(scene, material, material.specular_reflectance, "specular reflectance");
  if ((material.specular_reflectance > 0).any() && (material.transmittance > 0).any())
    refuse(scene, material,
           "both a specular reflectance and a transmittance; expected one of them, since the index decides the "
           "reflection of a clear material\nhint: ",
           "specular_reflectance=0");
}

// A sheet scatters all that it does not absorb.
void check_diffuse_transmittance(const Scene& scene, const Material& material) {
  check_share(scene, material, material.diffuse_transmittance, "diffuse transmittance");
  if (!(material.diffuse_transmittance > 0).any()) return;
  for (const auto& [other, name] : {std::pair(&material.transmittance, std::string("transmittance")),
                                    std::pair(&material.specular_reflectance, std::string("specular_reflectance"))}) {
    if ((*other > 0).any())
      refuse(scene, material,
             "both a diffuse transmittance and a " + name +
                 "; expected one of them, as sheets scatter all that they do not absorb\nhint: ",
             name + "=0");
  }
}

// A sheet transmits the same both ways.
void check_sheet(const Scene& scene, PolygonIndex index) {
  const Polygon& polygon = scene.polygons[index];
  if (!polygon.back_material) return;
  const Material& front = scene.materials[polygon.material];
  const Material& back = scene.materials[*polygon.back_material];
  const auto through = [&](const Material& material) -> Spectrum {
    if (material.diffuse_transmittance.size() > 0) return material.diffuse_transmittance;
    return Spectrum::Zero(number_of_bands(scene));
  };
  if ((through(front) == through(back)).all()) return;
  throw InputError(place_of(scene, polygon), "this face has material '" + front.name + "' on its front and '" +
                                                 back.name +
                                                 "' on its back, and their diffuse transmittances differ; expected the "
                                                 "same value on both sides\n"
                                                 "hint: read.settings MATERIAL.diffuse_transmittance=R,G,B");
}

void check_material(const Scene& scene, const Material& material) {
  for (const double rho : material.reflectance) {
    if (rho >= 0 && rho <= 1) continue;
    refuse(scene, material, "reflectance " + shortest(rho) + "; expected 0 to 1 in every band\nhint: fix Kd, or ",
           "reflectance=R,G,B");
  }
  if (material.texture && reflects_more_than_all(*material.texture))
    refuse(scene, material,
           "a picture that reflects more than 1 in places; expected 0 to 1 everywhere\n"
           "hint: a darker picture or a smaller factor, or ",
           "reflectance=R,G,B");
  check_share(scene, material, material.transmittance, "transmittance");
  check_specular_reflectance(scene, material);
  check_diffuse_transmittance(scene, material);
  if (!(material.index >= 1 && std::isfinite(material.index)))
    refuse(scene, material,
           "the index of refraction " + shortest(material.index) + "; expected a number of 1 or more\nhint: ",
           "index=1.52");
  for (const double exitance : material.exitance) {
    if (exitance >= 0 && std::isfinite(exitance)) continue;
    refuse(scene, material,
           "exitance " + shortest(exitance) + " W/m^2; expected a finite number not below 0\nhint: fix Ke, or ",
           "exitance=R,G,B");
  }
}

void check_size(const Scene& scene) {
  const double size = bounds(scene).sizes().maxCoeff();
  if (size >= shortest_model) return;
  throw InputError(scene.file, "the model is " + shortest(size) + " m long; expected at least " +
                                   shortest(shortest_model) + " m. Is its unit right?");
}

void check_polygon(const Scene& scene, PolygonIndex index) {
  const Polygon& polygon = scene.polygons[index];
  check_sheet(scene, index);
  if (polygon.corners.size() < 3) {
    throw InputError(place_of(scene, polygon), "this face has " + std::to_string(polygon.corners.size()) +
                                                   " corners; expected at least three. Remove the face");
  }
  const std::vector<Point> points = corner_points(scene, index);
  const Vector area = area_vector(points);
  double perimeter = 0;
  for (std::size_t k = 0; k < points.size(); ++k) perimeter += (points[(k + 1) % points.size()] - points[k]).norm();
  if (!(area.norm() > tolerance_of_arithmetic * perimeter * perimeter)) {
    throw InputError(place_of(scene, polygon),
                     "this face has no area\nhint: remove it, or merge its repeated vertices");
  }
  const Vector normal = area.normalized();
  for (const Point& point : points) {
    if (std::abs(normal.dot(point - points[0])) > 1e-4 * perimeter) {
      throw InputError(place_of(scene, polygon),
                       "the corners of this face do not lie in one plane\nhint: cut it into triangles");
    }
  }
}

}  // namespace

const char* name_of(Side side) { return side == Side::front ? "front" : "back"; }

Eigen::Index number_of_bands(const Scene& scene) { return scene.materials.front().reflectance.size(); }

Bands bands_of(const Scene& scene) { return scene.bands.empty() ? usual_bands(number_of_bands(scene)) : scene.bands; }

Diagnostics remarks_of(const Scene& scene) {
  return chosen(scene.diagnostics, [](DiagnosticCode code) { return !makes_results_wrong(code); });
}

std::vector<Point> corner_points(const Scene& scene, PolygonIndex polygon) {
  return corner_points(scene, scene.polygons[polygon].corners);
}

std::vector<Point> corner_points(const Scene& scene, std::span<const std::uint32_t> outline) {
  std::vector<Point> points;
  points.reserve(outline.size());
  for (const std::uint32_t corner : outline) points.push_back(scene.vertices[corner]);
  return points;
}

double polygon_area(const Scene& scene, PolygonIndex polygon) {
  return area_vector(corner_points(scene, polygon)).norm();
}

Box polygon_box(const Scene& scene, PolygonIndex polygon) {
  Box box;
  for (const std::uint32_t corner : scene.polygons[polygon].corners) box.extend(scene.vertices[corner]);
  return box;
}

Vector front_normal(const Scene& scene, PolygonIndex polygon) {
  const Vector area = area_vector(corner_points(scene, polygon));
  const double length = area.norm();
  return length > 0 ? Vector(area / length) : Vector(Vector::Zero());
}

MaterialIndex material_on(const Polygon& polygon, Side side) {
  return side == Side::back ? polygon.back_material.value_or(polygon.material) : polygon.material;
}

const TextureMap* texture_map_on(const Scene& scene, const Polygon& polygon, Side side) {
  if (!scene.materials[material_on(polygon, side)].texture) return nullptr;
  const bool is_own_back = side == Side::back && polygon.back_material;
  const std::uint32_t map = is_own_back ? polygon.back_texture_map : polygon.texture_map;
  return map == no_texture_map ? nullptr : &scene.texture_maps[map];
}

bool emits(const Scene& scene, PolygonIndex polygon, Side side) {
  const Polygon& face = scene.polygons[polygon];
  if (side == Side::back && !face.back_material) return false;
  return (scene.materials[material_on(face, side)].exitance > 0).any();
}

bool is_lamp(const Scene& scene, PolygonIndex polygon) {
  return emits(scene, polygon, Side::front) || emits(scene, polygon, Side::back);
}

bool has_point_or_daylight(const Scene& scene) { return !scene.luminaires.empty() || scene.sun || scene.sky; }

bool is_mirror(const Scene& scene, PolygonIndex polygon, Side side) {
  return (scene.materials[material_on(scene.polygons[polygon], side)].specular_reflectance > 0).any();
}

bool is_opening(const Scene& scene, PolygonIndex polygon) {
  const auto is_clear = [&](Side side) {
    return (scene.materials[material_on(scene.polygons[polygon], side)].transmittance > 0).any();
  };
  return is_clear(Side::front) || is_clear(Side::back);
}

bool is_sheet(const Scene& scene, PolygonIndex polygon) {
  return (scene.materials[scene.polygons[polygon].material].diffuse_transmittance > 0).any();
}

bool has_lamp(const Scene& scene) {
  if (has_point_or_daylight(scene)) return true;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_lamp(scene, p)) return true;
  }
  return false;
}

std::string place_of(const Scene& scene, const Polygon& polygon) {
  const std::string& file = polygon.file < scene.files.size() ? scene.files[polygon.file] : scene.file;
  if (polygon.line > 0) return file + ":" + std::to_string(polygon.line);
  return polygon.group < scene.groups.size() ? file + ": " + scene.groups[polygon.group] : file;
}

std::string group_name(const Scene& scene, std::uint32_t group) {
  return group < scene.groups.size() ? scene.groups[group] : "object " + std::to_string(group);
}

Vector upright_axis(const Scene& scene) {
  // Floors, ceilings, table tops: rooms have more area across their upright axis than across any other.
  constexpr double much_more = 1.25;
  Vector across = Vector::Zero();
  Vector shining = Vector::Zero();
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Spectrum& exitance = scene.materials[scene.polygons[p].material].exitance;
    const Vector area = area_vector(corner_points(scene, p));
    across += area.cwiseAbs();
    shining += exitance.sum() * area;
  }
  if (across.y() > much_more * across.z()) return Vector::UnitY();
  if (across.z() > much_more * across.y()) return Vector::UnitZ();
  const bool is_along_y = -shining.y() > 0.866 * shining.norm();  // within 30 degrees
  return is_along_y ? Vector::UnitY() : Vector::UnitZ();
}

Box bounds(const Scene& scene) {
  Box box;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) box.extend(polygon_box(scene, p));
  return box;
}

void check_vertices(const Scene& scene) {
  for (const Point& vertex : scene.vertices) {
    if (!vertex.allFinite()) throw InputError(scene.file, "a vertex is not finite; expected three finite coordinates");
    // Farther away, squares of areas would come near the largest double.
    if (vertex.cwiseAbs().maxCoeff() <= 1e15) continue;
    throw InputError(scene.file, "a vertex lies over 1e15 m from the origin; expected a model of earthly size");
  }
  for (const Polygon& polygon : scene.polygons) {
    if (polygon.corners.size() > most_corners) {
      throw InputError(place_of(scene, polygon), "this face has " + std::to_string(polygon.corners.size()) +
                                                     " corners; expected at most " + std::to_string(most_corners) +
                                                     "\nhint: cut it into smaller faces");
    }
    for (const std::uint32_t corner : polygon.corners) {
      if (corner < scene.vertices.size()) continue;
      throw InputError(place_of(scene, polygon), "this face uses vertex " + std::to_string(corner + 1) + " of " +
                                                     std::to_string(scene.vertices.size()) +
                                                     "; expected a vertex that exists");
    }
  }
}

void check(const Scene& scene) {
  if (scene.polygons.empty()) {
    throw InputError(scene.file, "found no faces; expected at least one polygon");
  }
  check_vertices(scene);
  check_bands(scene);
  for (const Material& material : scene.materials) check_material(scene, material);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) check_polygon(scene, p);
  check_size(scene);
}

const char* name_of(Projection projection) {
  constexpr std::array names = {"perspective", "orthographic", "angular", "hemispherical", "panorama"};
  return names[static_cast<std::size_t>(projection)];
}

std::optional<Projection> projection_named(const std::string& name) {
  using enum Projection;
  for (const Projection one : {perspective, orthographic, angular, hemispherical, panorama}) {
    if (name == name_of(one)) return one;
  }
  return std::nullopt;
}

double usual_field_of_view(Projection projection) { return projection == Projection::perspective ? 50 : 180; }

double largest_field_of_view(Projection projection) { return projection == Projection::angular ? 360 : 180; }

bool has_extent(const Camera& camera) {
  if (camera.projection == Projection::orthographic) return camera.height > 0 && std::isfinite(camera.height);
  const double angle = camera.vertical_field_of_view;
  const double largest = largest_field_of_view(camera.projection);
  return angle > 0 && (camera.projection == Projection::perspective ? angle < largest : angle <= largest);
}

std::string place_of(const SensorGroup& group, std::size_t sensor) {
  std::string place = "sensor " + std::to_string(sensor + 1) + " of '" + group.name + "'";
  if (group.lines.empty()) return place;
  return place + " (" + group.file + ":" + std::to_string(group.lines[std::min(sensor, group.lines.size() - 1)]) + ")";
}

std::vector<Sensor> all_sensors(const std::vector<SensorGroup>& groups) {
  std::vector<Sensor> all;
  for (const SensorGroup& group : groups) all.insert(all.end(), group.sensors.begin(), group.sensors.end());
  return all;
}

ModelFace model_face(const Scene& scene, const Polygon& polygon) {
  return {corner_points(scene, polygon.corners), polygon.file, polygon.line, polygon.face};
}

double area_of(const std::vector<ModelFace>& faces) {
  double area = 0;
  for (const ModelFace& face : faces) area += area_vector(face.corners).norm();
  return area;
}

bool is_loss(DiagnosticCode code) {
  return code == DiagnosticCode::left_out || code == DiagnosticCode::little_left_out;
}

std::set<std::string> objects_with_faces(const Scene& scene) {
  std::vector<std::uint8_t> has_polygon(scene.groups.size(), 0);
  for (const Polygon& polygon : scene.polygons) {
    if (polygon.group < scene.groups.size()) has_polygon[polygon.group] = 1;
  }
  std::set<std::string> names;
  for (std::size_t group = 0; group < scene.groups.size(); ++group) {
    if (has_polygon[group] != 0 && !scene.groups[group].empty()) names.insert(scene.groups[group]);
  }
  return names;
}

std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string listed(const Scene& scene, const std::vector<ModelFace>& faces) {
  Polygon first;
  first.file = faces.front().file;
  first.line = faces.front().line;
  first.group = static_cast<std::uint32_t>(scene.groups.size());  // unknown
  return counted(faces.size(), "face") + (faces.size() == 1 ? " (" : " (first at ") + place_of(scene, first) + ")";
}

}  // namespace patchlight
