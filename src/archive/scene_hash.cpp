#include "archive/scene_hash.h"

#include "base/parallel.h"
#include "files/sha256.h"
#include "scene/photometric_web.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <variant>
#include <vector>

namespace patchlight {
namespace {

void append(std::string& bytes, const Vector& vector) {
  for (const double coordinate : vector) {
    const auto raw = std::bit_cast<std::array<char, sizeof(double)>>(coordinate + 0.0);  // -0 becomes 0
    bytes.append(raw.data(), raw.size());
  }
}

class Bytes {
 public:
  void number(double value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(double)>>(value + 0.0);  // -0 becomes 0
    text_.append(raw.data(), raw.size());
  }
  // Includes their number, so that two lists cannot be confused with another two.
  void numbers(std::span<const double> values) {
    number(static_cast<double>(values.size()));
    for (const double value : values) number(value);
  }
  void spectrum(const Spectrum& spectrum) { numbers({spectrum.data(), static_cast<std::size_t>(spectrum.size())}); }
  void vector(const Vector& vector) { numbers({vector.data(), 3}); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void add_faces(Bytes& to, const Scene& scene) {
  for (const Point& vertex : scene.vertices) to.vector(vertex);
  for (const Polygon& polygon : scene.polygons) {
    const std::vector<double> corners(polygon.corners.begin(), polygon.corners.end());
    to.numbers(corners);
    to.number(polygon.material);
    to.number(polygon.back_material ? *polygon.back_material : -1.0);
    for (const Side side : {Side::front, Side::back}) {
      const TextureMap* map = texture_map_on(scene, polygon, side);
      if (!map) continue;
      to.numbers({map->linear.data(), 6});
      to.numbers({map->offset.data(), 2});
    }
  }
  to.vector(scene.up);
}

void add_texture(Bytes& to, const TexturedReflectance& textured) {
  for (const Spectrum& primary : textured.of_primaries) to.spectrum(primary);
  to.numbers(std::array{static_cast<double>(textured.wrap[0]), static_cast<double>(textured.wrap[1]),
                        static_cast<double>(textured.texture->width)});
  for (const auto& texel : textured.texture->texels)
    for (const float value : texel) to.number(value);
}

void add_materials(Bytes& to, const Scene& scene) {
  for (const Material& material : scene.materials) {
    for (const Spectrum* spectrum : {&material.reflectance, &material.exitance, &material.transmittance,
                                     &material.specular_reflectance, &material.diffuse_transmittance})
      to.spectrum(*spectrum);
    to.number(material.index);
    if (material.texture) add_texture(to, *material.texture);
  }
  for (const Band& band : bands_of(scene)) {
    to.number(band.luminous_weight);
    to.numbers(band.rgb);
  }
}

struct AddLight {
  Bytes& to;

  void operator()(const PointLight& light) const { to.spectrum(light.intensity); }
  void operator()(const SpotLight& light) const {
    to.spectrum(light.intensity);
    to.number(light.beam_half_angle);
    to.number(light.field_half_angle);
  }
  void operator()(const WebLight& light) const {
    to.spectrum(light.watts_per_lumen);
    const PhotometricWeb& web = *light.web;
    for (const auto* values : {&web.vertical, &web.horizontal, &web.candela, &web.tilt, &web.tilt_factor})
      to.numbers(*values);
    to.number(static_cast<double>(web.type));
  }
  void operator()(const SphericalLamp& light) const {
    to.number(light.radius);
    to.spectrum(light.exitance);
  }
};

void add_lights(Bytes& to, const Scene& scene) {
  for (const Luminaire& luminaire : scene.luminaires) {
    for (const Vector* vector : {&luminaire.position, &luminaire.aim, &luminaire.zero_plane}) to.vector(*vector);
    to.number(static_cast<double>(luminaire.light.index()));
    std::visit(AddLight{to}, luminaire.light);
  }
  if (scene.sun) {
    to.vector(scene.sun->direction);
    to.spectrum(scene.sun->normal_irradiance);
  }
  if (!scene.sky) return;
  const Sky& sky = *scene.sky;
  to.number(static_cast<double>(sky.kind));
  for (const Spectrum* spectrum : {&sky.horizontal_irradiance, &sky.zenith_radiance, &sky.ground_radiance})
    to.spectrum(*spectrum);
  to.vector(sky.sun_direction);
  to.number(sky.clearness);
  to.number(sky.brightness);
}

}  // namespace

std::string geometry_hash(const PatchMesh& mesh) {
  // Some patches together: a string of its own for each takes longer than the hash.
  constexpr PatchIndex together = 4096;
  std::vector<std::string> parts((mesh.size() + together - 1) / together);
  parallel_for(parts.size(), [&](std::size_t part) {
    const auto first = static_cast<PatchIndex>(part * together);
    std::string& bytes = parts[part];
    bytes.reserve(together * (1 + 15 * sizeof(double)));  // of four corners and the normal
    for (PatchIndex i = first; i < std::min(mesh.size(), first + together); ++i) {
      const PatchCorners corners = mesh.corner_points(i);
      bytes += static_cast<char>(corners.count);
      for (const Point& corner : std::span<const Point>(corners)) append(bytes, corner);
      append(bytes, mesh.normal[i]);
    }
  });
  return sha256(parts);
}

std::string scene_hash(const Scene& scene) {
  Bytes faces, materials, lights;
  add_faces(faces, scene);
  add_materials(materials, scene);
  add_lights(lights, scene);
  return sha256(std::array{faces.text(), materials.text(), lights.text()});
}

}  // namespace patchlight
