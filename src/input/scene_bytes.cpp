#include "input/scene_bytes.h"

#include "patchlight/base/error.h"

#include "files/isolated.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

namespace patchlight {
namespace {

void write_polygon(MessageWriter& out, const Polygon& polygon) {
  out.numbers(polygon.corners);
  out.plain(polygon.material);
  out.plain(polygon.group);
  out.plain(polygon.line);
  out.plain(polygon.texture_map);
  out.plain(polygon.back_material.has_value());
  if (polygon.back_material) out.plain(*polygon.back_material);
  out.plain(polygon.back_texture_map);
}

Polygon read_polygon(MessageReader& in) {
  Polygon polygon;
  polygon.corners.resize(in.count());
  for (std::uint32_t& corner : polygon.corners) corner = in.plain<std::uint32_t>();
  polygon.material = in.plain<MaterialIndex>();
  polygon.group = in.plain<std::uint32_t>();
  polygon.line = in.plain<std::uint32_t>();
  polygon.texture_map = in.plain<std::uint32_t>();
  if (in.plain<bool>()) polygon.back_material = in.plain<MaterialIndex>();
  polygon.back_texture_map = in.plain<std::uint32_t>();
  return polygon;
}

void write_stated(MessageWriter& out, const std::optional<StatedSurface>& stated) {
  out.plain(stated.has_value());
  if (!stated) return;
  out.text(stated->by);
  out.numbers(stated->matt_reflectance);
  out.numbers(stated->matt_exitance);
}

std::optional<StatedSurface> read_stated(MessageReader& in) {
  if (!in.plain<bool>()) return std::nullopt;
  StatedSurface stated;
  stated.by = in.text();
  stated.matt_reflectance = in.spectrum();
  stated.matt_exitance = in.spectrum();
  return stated;
}

using Textures = std::vector<std::shared_ptr<const Texture>>;

// The pictures of a scene's materials, each once.
Textures textures_of(const Scene& scene) {
  Textures textures;
  for (const Material& material : scene.materials) {
    if (!material.texture) continue;
    const auto& texture = material.texture->texture;
    if (std::find(textures.begin(), textures.end(), texture) == textures.end()) textures.push_back(texture);
  }
  return textures;
}

void write_textures(MessageWriter& out, const Textures& textures) {
  out.plain(textures.size());
  for (const auto& texture : textures) {
    out.plain(texture->width);
    out.plain(texture->height);
    out.texels(texture->texels);
  }
}

Textures read_textures(MessageReader& in) {
  Textures textures(in.count());
  for (auto& texture : textures) {
    Texture read;
    read.width = in.plain<std::uint32_t>();
    read.height = in.plain<std::uint32_t>();
    read.texels = in.texels();
    if (read.texels.empty() || read.texels.size() != std::uint64_t{read.width} * read.height)
      throw std::runtime_error("a picture has not the size that it says");
    texture = std::make_shared<const Texture>(std::move(read));
  }
  return textures;
}

void write_textured(MessageWriter& out, const std::optional<TexturedReflectance>& textured, const Textures& textures) {
  out.plain(textured.has_value());
  if (!textured) return;
  out.plain(
      static_cast<std::size_t>(std::find(textures.begin(), textures.end(), textured->texture) - textures.begin()));
  for (const Spectrum& primary : textured->of_primaries) out.numbers(primary);
  for (const Wrap wrap : textured->wrap) out.plain(static_cast<std::uint8_t>(wrap));
}

std::optional<TexturedReflectance> read_textured(MessageReader& in, const Textures& textures) {
  if (!in.plain<bool>()) return std::nullopt;
  TexturedReflectance textured;
  textured.texture = textures.at(in.plain<std::size_t>());
  for (Spectrum& primary : textured.of_primaries) primary = in.spectrum();
  for (Wrap& wrap : textured.wrap) wrap = static_cast<Wrap>(in.plain<std::uint8_t>());
  return textured;
}

void write_map(MessageWriter& out, const TextureMap& map) {
  for (const double value : map.linear.reshaped()) out.plain(value);
  for (const double value : map.offset) out.plain(value);
}

TextureMap read_map(MessageReader& in) {
  TextureMap map;
  for (double& value : map.linear.reshaped()) value = in.plain<double>();
  for (double& value : map.offset) value = in.plain<double>();
  return map;
}

void write_material(MessageWriter& out, const Material& material, const Textures& textures) {
  out.text(material.name);
  out.numbers(material.reflectance);
  out.numbers(material.exitance);
  out.numbers(material.transmittance);
  out.plain(material.index);
  out.numbers(material.specular_reflectance);
  out.numbers(material.diffuse_transmittance);
  write_stated(out, material.stated_pane);
  write_stated(out, material.stated_mirror);
  write_textured(out, material.texture, textures);
}

Material read_material(MessageReader& in, const Textures& textures) {
  Material material;
  material.name = in.text();
  material.reflectance = in.spectrum();
  material.exitance = in.spectrum();
  material.transmittance = in.spectrum();
  material.index = in.plain<double>();
  material.specular_reflectance = in.spectrum();
  material.diffuse_transmittance = in.spectrum();
  material.stated_pane = read_stated(in);
  material.stated_mirror = read_stated(in);
  material.texture = read_textured(in, textures);
  return material;
}

void write_room(MessageWriter& out, const NamedRoom& room) {
  out.text(room.name);
  out.text(room.storey);
  out.plain(room.faces.size());
  for (const std::vector<Point>& face : room.faces) {
    out.plain(face.size());
    for (const Point& corner : face) out.numbers(corner);
  }
}

NamedRoom read_room(MessageReader& in) {
  NamedRoom room;
  room.name = in.text();
  room.storey = in.text();
  room.faces.resize(in.count());
  for (std::vector<Point>& face : room.faces) {
    face.resize(in.count());
    for (Point& corner : face) corner = in.point();
  }
  return room;
}

}  // namespace

std::string scene_bytes(const Scene& scene) {
  MessageWriter out;
  out.plain(scene.vertices.size());
  for (const Point& vertex : scene.vertices) out.numbers(vertex);
  out.plain(scene.polygons.size());
  for (const Polygon& polygon : scene.polygons) write_polygon(out, polygon);
  const Textures textures = textures_of(scene);
  write_textures(out, textures);
  out.plain(scene.materials.size());
  for (const Material& material : scene.materials) write_material(out, material, textures);
  out.plain(scene.texture_maps.size());
  for (const TextureMap& map : scene.texture_maps) write_map(out, map);
  out.plain(scene.groups.size());
  for (const std::string& group : scene.groups) out.text(group);
  out.plain(scene.inputs.size());
  for (const std::filesystem::path& file : scene.inputs) out.text(file.string());
  out.plain(scene.unsimulated.size());
  for (const UnsimulatedMaterials& found : scene.unsimulated) {
    out.plain(static_cast<std::uint8_t>(found.property));
    out.plain(found.materials);
  }
  out.plain(scene.diagnostics.size());
  for (const Diagnostic& found : scene.diagnostics) {
    out.plain(static_cast<std::uint8_t>(found.code));
    out.plain(found.count);
    out.text(found.text);
    out.plain(found.area);
  }
  out.plain(scene.rooms.size());
  for (const NamedRoom& room : scene.rooms) write_room(out, room);
  out.text(scene.file);
  out.text(scene.sha256);
  out.plain(scene.metres_per_unit);
  out.numbers(scene.up);
  out.plain(scene.up_stated);
  return std::move(out).bytes();
}

Scene scene_from_bytes(std::string_view bytes) {
  MessageReader in(bytes);
  Scene scene;
  scene.vertices.resize(in.count());
  for (Point& vertex : scene.vertices) vertex = in.point();
  scene.polygons.resize(in.count());
  for (Polygon& polygon : scene.polygons) polygon = read_polygon(in);
  const Textures textures = read_textures(in);
  scene.materials.resize(in.count());
  for (Material& material : scene.materials) material = read_material(in, textures);
  scene.texture_maps.resize(in.count());
  for (TextureMap& map : scene.texture_maps) map = read_map(in);
  scene.groups.resize(in.count());
  for (std::string& group : scene.groups) group = in.text();
  scene.inputs.resize(in.count());
  for (std::filesystem::path& file : scene.inputs) file = in.text();
  scene.unsimulated.resize(in.count());
  for (UnsimulatedMaterials& found : scene.unsimulated) {
    found.property = static_cast<UnsimulatedProperty>(in.plain<std::uint8_t>());
    found.materials = in.plain<std::size_t>();
  }
  scene.diagnostics.resize(in.count());
  for (Diagnostic& found : scene.diagnostics) {
    found.code = static_cast<DiagnosticCode>(in.plain<std::uint8_t>());
    found.count = in.plain<std::size_t>();
    found.text = in.text();
    found.area = in.plain<double>();
  }
  scene.rooms.resize(in.count());
  for (NamedRoom& room : scene.rooms) room = read_room(in);
  scene.file = in.text();
  scene.sha256 = in.text();
  scene.metres_per_unit = in.plain<double>();
  scene.up = in.point();
  scene.up_stated = in.plain<bool>();
  return scene;
}

Scene read_isolated(const std::string& file, const std::function<Scene()>& read, const ChildLimits& limits) {
  const std::string bytes = bytes_isolated(
      file, [&] { return scene_bytes(read()); }, limits);
  try {
    return scene_from_bytes(bytes);
  } catch (const std::exception& error) {
    throw InputError(file, std::string("the reader of this format was damaged: ") + error.what());
  }
}

}  // namespace patchlight
