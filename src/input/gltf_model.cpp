#include "input/gltf_model.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/gltf_compression.h"
#include "input/picture_colours.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace patchlight {
namespace {

constexpr std::string_view glb_signature = "glTF";

// Extensions that a file may require: what they change is simulated, or named in the notes.
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

// The images by index, and by the digest of their bytes.
struct Pictures {
  std::map<int, std::string> digest;
  std::map<std::string, DecodedPicture> by_content;
};

// Of all of them, the texels that are kept.
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

// Keeps the texels that matter, of the same bytes once. A picture that cannot be decoded is no reason to stop.
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

// What may not be looked at counts as there: reading it is refused.
bool file_exists(const std::string& name, void* parts) {
  try {
    require_within(static_cast<GltfFiles*>(parts)->confine, name, name);
    return tinygltf::FileExists(name, nullptr);
  } catch (const InputError&) {
    return true;
  }
}

// One line, without the line ends that tinygltf puts between its sentences.
std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
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
    throw InputError(file.string(), "is not a good glTF 2.0 file: " + one_line(error) + "\nhint: export it again");
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
  // Each sum is compared in parts, so that none overflows.
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

}  // namespace patchlight
