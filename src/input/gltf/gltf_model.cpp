#include "input/gltf/gltf_model.h"

#include "patchlight/base/error.h"

#include "files/reason.h"
#include "files/sha256.h"
#include "input/picture_colours.h"
#include "input/text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <draco/compression/decode.h>
#include <limits>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

namespace patchlight {
namespace {

constexpr const char* meshopt = "EXT_meshopt_compression";
constexpr const char* draco_name = "KHR_draco_mesh_compression";
constexpr std::size_t glb_header = 12;
constexpr std::size_t chunk_header = 8;

std::string four_bytes(std::size_t number) {
  std::string bytes;
  for (unsigned k = 0; k < 4; ++k) bytes += static_cast<char>(number >> 8U * k & 0xFFU);
  return bytes;
}

std::size_t number_at(std::string_view bytes, std::size_t place) {
  std::size_t number = 0;
  for (unsigned k = 0; k < 4; ++k) number |= std::size_t{static_cast<unsigned char>(bytes[place + k])} << 8U * k;
  return number;
}

// The items of a list; null if there is no list.
nlohmann::json::array_t* items_of(nlohmann::json& table, const char* key) {
  return table.is_object() && table.contains(key) ? table[key].get_ptr<nlohmann::json::array_t*>() : nullptr;
}

bool has_extension(const nlohmann::json& item, const char* extension) {
  return item.is_object() && item.contains(nlohmann::json::json_pointer(std::string("/extensions/") + extension));
}

// JSON that tinygltf accepts: a buffer without data gets one byte, and draco triangles lose their indices.
std::string as_tinygltf_takes_it(const std::string& text) {
  nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (auto* const buffers = items_of(json, "buffers")) {
    for (nlohmann::json& buffer : *buffers) {
      if (!has_extension(buffer, meshopt) || buffer.contains("uri")) continue;
      buffer["uri"] = "data:application/octet-stream;base64,AA==";
      buffer["byteLength"] = 1;
    }
  }
  if (auto* const meshes = items_of(json, "meshes")) {
    for (nlohmann::json& mesh : *meshes) {
      auto* const primitives = items_of(mesh, "primitives");
      if (primitives == nullptr) continue;
      for (nlohmann::json& primitive : *primitives) {
        if (has_extension(primitive, draco_name)) primitive.erase("indices");
      }
    }
  }
  if (json.is_discarded()) return text;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

[[noreturn]] void refuse_packed(const std::string& file, const std::string& what, std::size_t index) {
  throw InputError(file,
                   what + " " + std::to_string(index) + " is compressed, and damaged\nhint: export the model again");
}

std::size_t count_in(const tinygltf::Value& table, const char* key) {
  const double number = table.Has(key) && table.Get(key).IsNumber() ? table.Get(key).GetNumberAsDouble() : 0;
  return number >= 0 && number <= 4e9 ? static_cast<std::size_t>(number) : 0;
}

std::string word_in(const tinygltf::Value& table, const char* key) {
  return table.Has(key) && table.Get(key).IsString() ? table.Get(key).Get<std::string>() : std::string();
}

// Part of a buffer's bytes; empty when out of range.
std::basic_string_view<unsigned char> part_of(const tinygltf::Model& model, std::size_t buffer, std::size_t offset,
                                              std::size_t length) {
  if (buffer >= model.buffers.size()) return {};
  const std::vector<unsigned char>& data = model.buffers[buffer].data;
  if (offset > data.size() || length > data.size() - offset) return {};
  return {data.data() + offset, length};
}

// The properties of a view compressed with EXT_meshopt_compression.
struct PackedView {
  std::string mode;
  std::string filter;
  std::size_t count = 0;
  std::size_t stride = 0;
};

bool unpack_attributes(const PackedView& view, std::basic_string_view<unsigned char> packed, unsigned char* into) {
  const auto [count, stride] = std::pair(view.count, view.stride);
  if (stride % 4 != 0 || meshopt_decodeVertexBuffer(into, count, stride, packed.data(), packed.size()) != 0)
    return false;
  if (view.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) meshopt_decodeFilterOct(into, count, stride);
  if (view.filter == "QUATERNION" && stride == 8) meshopt_decodeFilterQuat(into, count, stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(into, count, stride);
  return true;
}

bool unpack_indices(const PackedView& view, std::basic_string_view<unsigned char> packed, unsigned char* into) {
  const auto [count, stride] = std::pair(view.count, view.stride);
  if (stride != 2 && stride != 4) return false;
  if (view.mode == "INDICES")
    return meshopt_decodeIndexSequence(into, count, stride, packed.data(), packed.size()) == 0;
  return view.mode == "TRIANGLES" && count % 3 == 0 &&
         meshopt_decodeIndexBuffer(into, count, stride, packed.data(), packed.size()) == 0;
}

// The decompressed bytes of a view; empty if damaged.
std::vector<unsigned char> unpacked(const PackedView& view, std::basic_string_view<unsigned char> packed) {
  if (packed.empty() || view.count == 0 || view.stride == 0 || view.stride > 256 ||
      view.count > (std::size_t{1} << 31U) / view.stride)
    return {};
  std::vector<unsigned char> bytes(view.count * view.stride);
  const bool good = view.mode == "ATTRIBUTES" ? unpack_attributes(view, packed, bytes.data())
                                              : unpack_indices(view, packed, bytes.data());
  return good ? bytes : std::vector<unsigned char>{};
}

tinygltf::Model with_unpacked_view(tinygltf::Model model, std::size_t index, const std::string& file) {
  const tinygltf::Value& packed = model.bufferViews[index].extensions.at(meshopt);
  const PackedView stated{word_in(packed, "mode"), word_in(packed, "filter"), count_in(packed, "count"),
                          count_in(packed, "byteStride")};
  tinygltf::Buffer buffer;
  buffer.data = unpacked(stated, part_of(model, count_in(packed, "buffer"), count_in(packed, "byteOffset"),
                                         count_in(packed, "byteLength")));
  if (buffer.data.empty()) refuse_packed(file, "buffer view", index);
  tinygltf::BufferView& view = model.bufferViews[index];
  view.buffer = static_cast<int>(model.buffers.size());
  view.byteOffset = 0;
  view.byteLength = buffer.data.size();
  model.buffers.push_back(std::move(buffer));
  return model;
}

// Adds an accessor of plain values with a buffer of its own.
template <typename Number>
tinygltf::Model with_values(tinygltf::Model model, int accessor, const std::vector<Number>& values, int components) {
  tinygltf::Buffer buffer;
  buffer.data.resize(values.size() * sizeof(Number));
  if (!values.empty()) std::memcpy(buffer.data.data(), values.data(), buffer.data.size());
  tinygltf::BufferView view;
  view.buffer = static_cast<int>(model.buffers.size());
  view.byteLength = buffer.data.size();
  tinygltf::Accessor& plain = model.accessors[static_cast<std::size_t>(accessor)];
  plain.bufferView = static_cast<int>(model.bufferViews.size());
  plain.byteOffset = 0;
  plain.componentType =
      std::is_same_v<Number, float> ? TINYGLTF_COMPONENT_TYPE_FLOAT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  plain.normalized = false;
  plain.count = values.size() / static_cast<std::size_t>(components);
  model.buffers.push_back(std::move(buffer));
  model.bufferViews.push_back(std::move(view));
  return model;
}

bool is_accessor(const tinygltf::Model& model, int accessor) {
  return accessor >= 0 && static_cast<std::size_t>(accessor) < model.accessors.size();
}

// Decodes a primitive's draco mesh; null if damaged.
std::unique_ptr<draco::Mesh> draco_mesh(const tinygltf::Model& model, const tinygltf::Value& packed) {
  const std::size_t view = count_in(packed, "bufferView");
  if (view >= model.bufferViews.size()) return nullptr;
  const tinygltf::BufferView& place = model.bufferViews[view];
  const auto bytes =
      part_of(model, static_cast<std::size_t>(std::max(0, place.buffer)), place.byteOffset, place.byteLength);
  if (bytes.empty()) return nullptr;
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  return decoded.ok() ? std::move(decoded).value() : nullptr;
}

// Three coordinates for each point; empty if unknown.
std::vector<float> positions_of(const draco::Mesh& mesh, const tinygltf::Value& packed) {
  if (!packed.Has("attributes") || !packed.Get("attributes").Has("POSITION")) return {};
  const draco::PointAttribute* const attribute =
      mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(count_in(packed.Get("attributes"), "POSITION")));
  if (attribute == nullptr || attribute->num_components() != 3) return {};
  std::vector<float> values(std::size_t{3} * mesh.num_points());
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    if (!attribute->ConvertValue<float, 3>(attribute->mapped_index(point),
                                           values.data() + std::size_t{3} * point.value()))
      return {};
  }
  return values;
}

tinygltf::Model with_unpacked_primitive(tinygltf::Model model, std::size_t mesh, std::size_t part,
                                        const std::string& file) {
  const tinygltf::Primitive primitive = model.meshes[mesh].primitives[part];
  const tinygltf::Value& packed = primitive.extensions.at(draco_name);
  const auto positions = primitive.attributes.find("POSITION");
  const std::unique_ptr<draco::Mesh> decoded = draco_mesh(model, packed);
  const std::vector<float> values = decoded ? positions_of(*decoded, packed) : std::vector<float>{};
  if (values.empty() || positions == primitive.attributes.end() || !is_accessor(model, positions->second))
    refuse_packed(file, "mesh", mesh);
  std::vector<std::uint32_t> corners;
  for (draco::FaceIndex face(0); face < decoded->num_faces(); ++face)
    for (const draco::PointIndex& corner : decoded->face(face)) corners.push_back(corner.value());
  int indices = primitive.indices;
  if (!is_accessor(model, indices)) {
    indices = static_cast<int>(model.accessors.size());
    model.accessors.emplace_back();
    model.accessors.back().type = TINYGLTF_TYPE_SCALAR;
  }
  model.meshes[mesh].primitives[part].indices = indices;
  model.meshes[mesh].primitives[part].mode = TINYGLTF_MODE_TRIANGLES;
  model = with_values(std::move(model), positions->second, values, 3);
  return with_values(std::move(model), indices, corners, 1);
}

// A .gltf or .glb file without the parts of compressed data that tinygltf refuses: placeholder buffers of
// EXT_meshopt_compression become empty, and triangles of KHR_draco_mesh_compression lose their indices. Other files are
// unchanged.
std::string readable_gltf(const std::string& bytes) {
  if (bytes.find(meshopt) == std::string::npos && bytes.find(draco_name) == std::string::npos) return bytes;
  if (!bytes.starts_with("glTF")) return as_tinygltf_takes_it(bytes);
  if (bytes.size() < glb_header + chunk_header) return bytes;
  const std::size_t length = number_at(bytes, glb_header);
  const std::size_t begin = glb_header + chunk_header;
  if (length > bytes.size() - begin) return bytes;
  std::string json = as_tinygltf_takes_it(bytes.substr(begin, length));
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string rest = bytes.substr(begin + length);
  return bytes.substr(0, 8) + four_bytes(begin + json.size() + rest.size()) + four_bytes(json.size()) +
         bytes.substr(glb_header + 4, 4) + json + rest;
}

// Unpacks views with EXT_meshopt_compression, and positions and triangles with KHR_draco_mesh_compression. Throws
// InputError naming `file` if they are damaged.
tinygltf::Model decompressed(tinygltf::Model model, const std::string& file) {
  for (std::size_t k = 0; k < model.bufferViews.size(); ++k) {
    if (model.bufferViews[k].extensions.count(meshopt) > 0) model = with_unpacked_view(std::move(model), k, file);
  }
  for (std::size_t k = 0; k < model.meshes.size(); ++k) {
    for (std::size_t part = 0; part < model.meshes[k].primitives.size(); ++part) {
      if (model.meshes[k].primitives[part].extensions.count(draco_name) > 0)
        model = with_unpacked_primitive(std::move(model), k, part, file);
    }
  }
  return model;
}

constexpr std::string_view glb_signature = "glTF";

// Required extensions that the reader simulates or mentions in notes.
bool is_known(const std::string& extension) {
  static constexpr std::array<std::string_view, 8> known = {
      "KHR_mesh_quantization", "KHR_texture_transform", "KHR_lights_punctual",        "KHR_texture_basisu",
      "EXT_texture_webp",      "MSFT_texture_dds",      "KHR_draco_mesh_compression", "EXT_meshopt_compression"};
  return extension.starts_with("KHR_materials_") || std::find(known.begin(), known.end(), extension) != known.end();
}

void require_known_extensions(const tinygltf::Model& model, const std::string& file) {
  for (const std::string& extension : model.extensionsRequired) {
    if (is_known(extension)) continue;
    throw InputError(
        file, "requires the extension " + extension + ", which is not supported\nhint: export the model without it");
  }
}

// Images by index, and by the digest of their bytes.
struct Pictures {
  std::map<int, std::string> digest;
  std::map<std::string, DecodedPicture> by_content;
};

// Reduces all pictures to the number of texels that may be kept.
void limit_texels(Pictures& pictures) {
  std::size_t texels = 0;
  for (const auto& [digest, picture] : pictures.by_content)
    if (picture.texture) texels += picture.texture->texels.size();
  if (texels <= most_texels_of_model) return;
  const std::size_t most = std::max(most_texels_of_model / pictures.by_content.size(), std::size_t{1});
  for (auto& [digest, picture] : pictures.by_content)
    if (picture.texture) picture.texture = std::make_shared<const Texture>(reduced(*picture.texture, most));
}

GltfModel with_pictures(GltfModel model, Pictures pictures) {
  limit_texels(pictures);
  for (const auto& [image, digest] : pictures.digest) {
    const DecodedPicture& picture = pictures.by_content[digest];
    if (picture.mean) model.mean_color.emplace(image, *picture.mean);
    if (picture.texture) model.textures.emplace(image, picture.texture);
    if (picture.alpha) model.alpha.emplace(image, picture.alpha);
    if (!picture.mean) model.picture_faults.emplace(image, picture.fault);
  }
  return model;
}

// Keeps a reduced picture, shared by images with the same bytes. A picture that cannot be decoded is not an error.
// NOLINTNEXTLINE(readability-function-size): the library fixes the parameters
bool take_image(tinygltf::Image*, int index, std::string*, std::string*, int, int, const unsigned char* bytes, int size,
                void* into) {
  const std::string text(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(size));
  auto& pictures = *static_cast<Pictures*>(into);
  const auto [known, is_new] = pictures.by_content.try_emplace(sha256({&text, 1}));
  if (is_new) known->second = decoded_picture(text, most_texels_of_picture);
  pictures.digest.emplace(index, known->first);
  return true;
}

bool read_file(std::vector<unsigned char>* out, std::string* error, const std::string& name, void* parts) {
  try {
    auto& files = *static_cast<GltfFiles*>(parts);
    require_within(files.confine, name, "the model");
    files.bytes.push_back(read_text(name, name, "the file"));
    files.names.emplace_back(name);
    out->assign(files.bytes.back().begin(), files.bytes.back().end());
    return true;
  } catch (const InputError& refused) {
    *error = refused.what();
    return false;
  }
}

// Files outside `confine` count as existing: reading them is refused later.
bool file_exists(const std::string& name, void* parts) {
  try {
    require_within(static_cast<GltfFiles*>(parts)->confine, name, name);
    return tinygltf::FileExists(name, nullptr);
  } catch (const InputError&) {
    return true;
  }
}

std::size_t bytes_per_value(int component_type) {
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(component_type));
  return size > 0 ? static_cast<std::size_t>(size) : 0;
}

template <typename Value>
double value_at(const unsigned char* bytes, bool normalized) {
  Value value;
  std::memcpy(&value, bytes, sizeof value);
  if (!normalized) return static_cast<double>(value);
  return std::max(-1.0, static_cast<double>(value) / static_cast<double>(std::numeric_limits<Value>::max()));
}

double value_at(const unsigned char* bytes, int component_type, bool normalized) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return value_at<std::int8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return value_at<std::uint8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return value_at<std::int16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return value_at<std::uint16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return value_at<std::uint32_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_DOUBLE:
      return value_at<double>(bytes, false);
    default:
      return value_at<float>(bytes, false);
  }
}

template <typename Item>
const Item& item(const std::vector<Item>& items, int index, const char* what, const std::string& file) {
  if (index < 0 || static_cast<std::size_t>(index) >= items.size()) {
    throw InputError(file, std::string("names ") + what + " " + std::to_string(index) +
                               ", which is not in the file\nhint: export it again");
  }
  return items[static_cast<std::size_t>(index)];
}

Wrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp;
  return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirror : Wrap::repeat;
}

// KHR_texture_transform: scale, rotate about the origin, counter-clockwise in the picture with v downward, and shift.
struct TextureTransform {
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  std::optional<int> set;
};

Eigen::Vector2d pair_of(const tinygltf::Value& extension, const char* key, double otherwise) {
  Eigen::Vector2d pair(otherwise, otherwise);
  if (!extension.Has(key) || extension.Get(key).ArrayLen() < 2) return pair;
  for (int k = 0; k < 2; ++k) pair[k] = extension.Get(key).Get(static_cast<std::size_t>(k)).GetNumberAsDouble();
  return pair;
}

TextureTransform transform_of(const tinygltf::TextureInfo& texture) {
  TextureTransform transform;
  const auto found = texture.extensions.find("KHR_texture_transform");
  if (found == texture.extensions.end()) return transform;
  const tinygltf::Value& extension = found->second;
  const double angle = extension.Has("rotation") ? extension.Get("rotation").GetNumberAsDouble() : 0;
  Eigen::Matrix2d turn;
  turn << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
  transform.linear = turn * pair_of(extension, "scale", 1).asDiagonal();
  transform.offset = pair_of(extension, "offset", 0);
  if (extension.Has("texCoord")) transform.set = extension.Get("texCoord").GetNumberAsInt();
  return transform;
}

}  // namespace

GltfModel read_gltf_model(const std::filesystem::path& file, const std::filesystem::path& confine) {
  GltfModel result;
  result.files.confine = confine;
  result.files.bytes.push_back(read_text(file, file.string(), "the model file"));
  const std::string bytes = readable_gltf(result.files.bytes[0]);
  if (bytes.size() > std::numeric_limits<unsigned int>::max()) throw InputError(file.string(), "is larger than 4 GB");
  const auto size = static_cast<unsigned int>(bytes.size());

  tinygltf::TinyGLTF reader;
  Pictures pictures;
  reader.SetImageLoader(take_image, &pictures);
  reader.SetFsCallbacks({file_exists, tinygltf::ExpandFilePath, read_file, tinygltf::WriteWholeFile, &result.files});
  std::string error;
  std::string warning;
  const std::string folder = file.parent_path().string();
  const bool good =
      bytes.starts_with(glb_signature)
          ? reader.LoadBinaryFromMemory(&result.model, &error, &warning,
                                        reinterpret_cast<const unsigned char*>(bytes.data()), size, folder)
          : reader.LoadASCIIFromString(&result.model, &error, &warning, bytes.data(), size, folder);
  result = with_pictures(std::move(result), std::move(pictures));
  require_known_extensions(result.model, file.string());
  if (!good) {
    throw InputError(file.string(), "is not a good glTF 2.0 file: " + reason_of(error) + "\nhint: export it again");
  }
  result.model = decompressed(std::move(result.model), file.string());
  return result;
}

std::vector<double> accessor_values(const tinygltf::Model& model, int accessor, int components,
                                    const std::string& file) {
  const tinygltf::Accessor& list = item(model.accessors, accessor, "accessor", file);
  const std::string name = "accessor " + std::to_string(accessor);
  if (list.sparse.isSparse || list.bufferView < 0) {
    throw InputError(file, name + " is sparse or empty, which is not supported\nhint: export the model without that");
  }
  const tinygltf::BufferView& view = item(model.bufferViews, list.bufferView, "buffer view", file);
  const tinygltf::Buffer& buffer = item(model.buffers, view.buffer, "buffer", file);
  const std::size_t value_size = bytes_per_value(list.componentType);
  const std::size_t element = value_size * static_cast<std::size_t>(components);
  const std::size_t stride = view.byteStride > 0 ? view.byteStride : element;
  const int expected_type = components == 1   ? TINYGLTF_TYPE_SCALAR
                            : components == 2 ? TINYGLTF_TYPE_VEC2
                                              : TINYGLTF_TYPE_VEC3;
  // Compares each sum in parts, to avoid overflow.
  const std::size_t end = buffer.data.size();
  const bool fits = value_size > 0 && list.type == expected_type && view.byteOffset <= end &&
                    list.byteOffset <= end - view.byteOffset && element <= end - view.byteOffset - list.byteOffset &&
                    list.count > 0 && list.count - 1 <= (end - view.byteOffset - list.byteOffset - element) / stride;
  if (!fits) throw InputError(file, name + " has a wrong type or leaves its buffer\nhint: export the model again");

  std::vector<double> values;
  values.reserve(list.count * static_cast<std::size_t>(components));
  const unsigned char* first = buffer.data.data() + view.byteOffset + list.byteOffset;
  for (std::size_t k = 0; k < list.count; ++k) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(components); ++c) {
      values.push_back(value_at(first + k * stride + c * value_size, list.componentType, list.normalized));
    }
  }
  return values;
}

std::array<Wrap, 2> gltf_wrap(const tinygltf::Model& model, int texture) {
  const int sampler = model.textures[static_cast<std::size_t>(texture)].sampler;
  if (sampler < 0 || static_cast<std::size_t>(sampler) >= model.samplers.size()) return {};
  const tinygltf::Sampler& stated = model.samplers[static_cast<std::size_t>(sampler)];
  return {wrap_of(stated.wrapS), wrap_of(stated.wrapT)};
}

std::vector<Eigen::Vector2d> gltf_places(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                         const tinygltf::TextureInfo& texture, const std::string& file) {
  const TextureTransform transform = transform_of(texture);
  const auto set = primitive.attributes.find("TEXCOORD_" + std::to_string(transform.set.value_or(texture.texCoord)));
  if (set == primitive.attributes.end()) return {};
  const std::vector<double> values = accessor_values(model, set->second, 2, file);
  std::vector<Eigen::Vector2d> places;
  for (std::size_t k = 0; k + 1 < values.size(); k += 2)
    places.emplace_back(transform.linear * Eigen::Vector2d(values[k], values[k + 1]) + transform.offset);
  return places;
}

}  // namespace patchlight
