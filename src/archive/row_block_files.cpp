#include "archive/row_block_files.h"

#include "patchlight/base/error.h"
#include "patchlight/output/provenance.h"

#include "archive/geometry_hash.h"
#include "archive/npy.h"
#include "files/sha256.h"
#include "output/mesh/append_bytes.h"
#include "scene/specular_faces.h"

#include <array>
#include <system_error>

namespace patchlight {
namespace {

// To be raised when rows are found in another way, so that blocks of before are not taken.
constexpr std::uint32_t way_of_finding = 2;

std::string bytes_of_faces(const Scene& scene) {
  std::string bytes;
  const SpecularFaces specular(scene, Reflections::followed);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Vector normal = front_normal(scene, p);
    for (const Side side : {Side::front, Side::back}) append_bytes(bytes, specular.held(p, side));
    append_bytes(bytes, specular.transmittance(p, normal));
    for (const Vector& direction : {normal, Vector(-normal)}) append_bytes(bytes, specular.reflectance(p, direction));
    append_bytes(bytes, scene.polygons[p].corners.size());
    for (const Point& corner : corner_points(scene, p)) {
      for (const double coordinate : corner) append_bytes(bytes, coordinate);
    }
  }
  return bytes;
}

std::string bytes_of_effects(const EffectOptions& effects) {
  std::string bytes;
  for (const auto* list : {&effects.force, &effects.skip}) {
    append_bytes(bytes, list->size());
    for (const Effect effect : *list) append_bytes(bytes, static_cast<std::int32_t>(effect));
  }
  return bytes;
}

std::string bytes_of(const RayOptions& options, std::span<const float> bright_densities) {
  std::string bytes;
  append_bytes(bytes, way_of_finding);
  append_bytes(bytes, options.rays);
  append_bytes(bytes, options.toward_bright);
  append_bytes(bytes, options.seed);
  for (const std::uint8_t doublings : options.doublings) append_bytes(bytes, doublings);
  for (const float density : bright_densities) append_bytes(bytes, density);
  return bytes;
}

std::string name_begin(const std::string& key) { return "rows_" + key + "_"; }

// 32 bits of a SHA-256 of a block.
std::int32_t digest(const std::string& key, std::size_t block, std::span<const std::int32_t> words) {
  constexpr std::size_t digits = 8;
  constexpr int hexadecimal = 16;
  std::string bytes;
  append_bytes(bytes, block);
  bytes.append(reinterpret_cast<const char*>(words.data()), words.size_bytes());
  const std::array parts{key, std::move(bytes)};
  return static_cast<std::int32_t>(std::stoul(sha256(parts).substr(0, digits), nullptr, hexadecimal));
}

}  // namespace

std::string row_key(const RowScene& of, const PatchMesh& mesh, const RayOptions& options,
                    std::span<const float> bright_densities) {
  constexpr std::size_t digits = 16;
  const std::array parts{std::string(version()), geometry_hash(mesh), bytes_of_faces(of.scene),
                         bytes_of_effects(of.effects), bytes_of(options, bright_densities)};
  return sha256(parts).substr(0, digits);
}

RowBlocks row_blocks_in(const std::filesystem::path& folder, const std::string& key) {
  const auto file = [folder, key](std::size_t block) {
    return folder / (name_begin(key) + std::to_string(block) + ".npy");
  };
  const auto read = [file, key](std::size_t block) -> std::optional<std::vector<std::int32_t>> {
    try {
      if (!std::filesystem::exists(file(block))) return std::nullopt;
      const auto stored = read_npy_numbers<std::int32_t>(file(block), npy_count(file(block)));
      if (stored.empty()) return std::nullopt;
      std::vector<std::int32_t> words(stored.begin(), stored.end() - 1);
      if (stored.back() != digest(key, block, words)) return std::nullopt;
      return words;
    } catch (const InputError&) {
      return std::nullopt;
    } catch (const std::filesystem::filesystem_error&) {
      return std::nullopt;
    }
  };
  const auto keep = [folder, file, key](std::size_t block, std::span<const std::int32_t> words) {
    // A run that shares the folder may have removed it, when nothing was in it.
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    std::vector<std::int32_t> stored(words.begin(), words.end());
    stored.push_back(digest(key, block, words));
    write_npy_numbers(file(block), std::span<const std::int32_t>(stored));
  };
  return {read, keep};
}

void remove_row_blocks(const std::filesystem::path& folder, std::span<const std::string> keys) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    for (const std::string& key : keys) {
      if (name.starts_with(name_begin(key))) files.push_back(entry->path());
    }
  }
  for (const std::filesystem::path& file : files) std::filesystem::remove(file, error);
}

}  // namespace patchlight
