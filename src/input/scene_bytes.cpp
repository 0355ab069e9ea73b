#include "input/scene_bytes.h"

#include "patchlight/base/error.h"

#include <algorithm>
#include <concepts>
#include <memory>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

template <class Value, class Type>
concept Is = std::same_as<std::remove_const_t<Value>, Type>;

// The serialized members of a type, in order.
auto members_of(Is<Polygon> auto& polygon) {
  return std::tie(polygon.corners, polygon.material, polygon.group, polygon.line, polygon.texture_map,
                  polygon.back_material, polygon.back_texture_map);
}
auto members_of(Is<StatedSurface> auto& stated) {
  return std::tie(stated.by, stated.matt_reflectance, stated.matt_exitance);
}
auto members_of(Is<TexturedReflectance> auto& textured) {
  return std::tie(textured.texture, textured.of_primaries, textured.wrap);
}
auto members_of(Is<Material> auto& material) {
  return std::tie(material.name, material.reflectance, material.exitance, material.transmittance, material.index,
                  material.specular_reflectance, material.diffuse_transmittance, material.stated_pane,
                  material.stated_mirror, material.texture);
}
auto members_of(Is<TextureMap> auto& map) { return std::tie(map.linear, map.offset); }
auto members_of(Is<UnsimulatedMaterials> auto& found) { return std::tie(found.property, found.materials); }
auto members_of(Is<Diagnostic> auto& found) { return std::tie(found.code, found.count, found.text, found.area); }
auto members_of(Is<NamedRoom> auto& room) { return std::tie(room.name, room.storey, room.faces); }
auto members_of(Is<Scene> auto& scene) {
  return std::tie(scene.vertices, scene.polygons, scene.materials, scene.texture_maps, scene.groups, scene.inputs,
                  scene.unsimulated, scene.diagnostics, scene.rooms, scene.file, scene.sha256, scene.metres_per_unit,
                  scene.up, scene.up_stated);
}

using TexturePointer = std::shared_ptr<const Texture>;
using Textures = std::vector<TexturePointer>;

// The distinct textures of a scene's materials. Materials refer to them by index.
Textures textures_of(const Scene& scene) {
  Textures textures;
  for (const Material& material : scene.materials) {
    if (!material.texture) continue;
    const TexturePointer& texture = material.texture->texture;
    if (std::find(textures.begin(), textures.end(), texture) == textures.end()) textures.push_back(texture);
  }
  return textures;
}

void write_value(MessageWriter& out, const auto& value, const Textures& textures) {
  using Value = std::remove_cvref_t<decltype(value)>;
  const auto write_all = [&](const auto&... values) { (write_value(out, values, textures), ...); };
  if constexpr (std::is_arithmetic_v<Value>) {
    out.plain(value);
  } else if constexpr (std::is_enum_v<Value>) {
    out.plain(static_cast<std::underlying_type_t<Value>>(value));
  } else if constexpr (std::same_as<Value, std::string>) {
    out.text(value);
  } else if constexpr (std::same_as<Value, std::filesystem::path>) {
    out.text(value.string());
  } else if constexpr (std::same_as<Value, Spectrum> || std::same_as<Value, Point>) {
    out.numbers(value);
  } else if constexpr (std::same_as<Value, TexturePointer>) {
    out.plain(static_cast<std::size_t>(std::find(textures.begin(), textures.end(), value) - textures.begin()));
  } else if constexpr (requires { value.has_value(); }) {
    out.plain(value.has_value());
    if (value) write_all(*value);
  } else if constexpr (requires { value.reshaped(); }) {
    for (const double number : value.reshaped()) out.plain(number);
  } else if constexpr (requires { value.begin(); }) {
    if constexpr (requires { value.capacity(); }) out.plain(value.size());
    for (const auto& item : value) write_all(item);
  } else {
    std::apply(write_all, members_of(value));
  }
}

void read_value(MessageReader& in, auto& value, const Textures& textures) {
  using Value = std::remove_cvref_t<decltype(value)>;
  const auto read_all = [&](auto&... values) { (read_value(in, values, textures), ...); };
  if constexpr (std::is_arithmetic_v<Value>) {
    value = in.plain<Value>();
  } else if constexpr (std::is_enum_v<Value>) {
    value = static_cast<Value>(in.plain<std::underlying_type_t<Value>>());
  } else if constexpr (std::same_as<Value, std::string> || std::same_as<Value, std::filesystem::path>) {
    value = in.text();
  } else if constexpr (std::same_as<Value, Spectrum>) {
    value = in.spectrum();
  } else if constexpr (std::same_as<Value, Point>) {
    value = in.point();
  } else if constexpr (std::same_as<Value, TexturePointer>) {
    value = textures.at(in.plain<std::size_t>());
  } else if constexpr (requires { value.has_value(); }) {
    if (in.plain<bool>()) read_all(value.emplace());
  } else if constexpr (requires { value.reshaped(); }) {
    for (double& number : value.reshaped()) number = in.plain<double>();
  } else if constexpr (requires { value.begin(); }) {
    if constexpr (requires { value.capacity(); }) value.resize(in.count());
    for (auto& item : value) read_all(item);
  } else {
    std::apply(read_all, members_of(value));
  }
}

TexturePointer read_texture(MessageReader& in) {
  Texture texture;
  texture.width = in.plain<std::uint32_t>();
  texture.height = in.plain<std::uint32_t>();
  texture.texels = in.texels();
  if (texture.texels.empty() || texture.texels.size() != std::uint64_t{texture.width} * texture.height)
    throw std::runtime_error("the size of a picture is wrong");
  return std::make_shared<const Texture>(std::move(texture));
}

}  // namespace

std::string scene_bytes(const Scene& scene) {
  MessageWriter out;
  const Textures textures = textures_of(scene);
  out.plain(textures.size());
  for (const TexturePointer& texture : textures) {
    out.plain(texture->width);
    out.plain(texture->height);
    out.texels(texture->texels);
  }
  write_value(out, scene, textures);
  return std::move(out).bytes();
}

Scene scene_from_bytes(std::string_view bytes) {
  MessageReader in(bytes);
  Textures textures(in.count());
  for (TexturePointer& texture : textures) texture = read_texture(in);
  Scene scene;
  read_value(in, scene, textures);
  return scene;
}

Scene read_isolated(const std::string& file, const std::function<Scene()>& make, const ChildLimits& limits) {
  const std::string bytes = bytes_isolated(
      file, [&] { return scene_bytes(make()); }, limits);
  try {
    return scene_from_bytes(bytes);
  } catch (const std::exception& error) {
    throw InputError(file, std::string("the reader of this format was damaged: ") + error.what());
  }
}

}  // namespace patchlight
