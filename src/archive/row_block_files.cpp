#include "archive/row_block_files.h"

#include "patchlight/base/error.h"
#include "patchlight/output/provenance.h"

#include "archive/geometry_hash.h"
#include "archive/npy.h"
#include "files/sha256.h"
#include "scene/transmittance.h"

#include <array>
#include <bit>
#include <system_error>

namespace patchlight {
namespace {

template <class Number>
void append(std::string& bytes, Number number) {
  const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  bytes.append(raw.data(), raw.size());
}

std::string bytes_of_faces(const Scene& scene) {
  std::string bytes;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    append(bytes, mean_transmittance(scene, p));
    for (const Point& corner : corner_points(scene, p)) {
      for (const double coordinate : corner) append(bytes, coordinate);
    }
  }
  return bytes;
}

std::string bytes_of(const RayOptions& options, std::span<const float> bright_densities) {
  std::string bytes;
  append(bytes, options.rays), append(bytes, options.toward_bright), append(bytes, options.seed);
  for (const float density : bright_densities) append(bytes, density);
  return bytes;
}

std::string name_begin(const std::string& key) { return "rows_" + key + "_"; }

}  // namespace

std::string row_key(const Scene& scene, const PatchMesh& mesh, const RayOptions& options,
                    std::span<const float> bright_densities) {
  constexpr std::size_t digits = 16;
  const std::array parts{std::string(version()), geometry_hash(mesh), bytes_of_faces(scene),
                         bytes_of(options, bright_densities)};
  return sha256(parts).substr(0, digits);
}

RowBlocks row_blocks_in(const std::filesystem::path& folder, const std::string& key) {
  const auto file = [folder, key](std::size_t block) {
    return folder / (name_begin(key) + std::to_string(block) + ".npy");
  };
  return {[file](std::size_t block) -> std::optional<std::vector<std::int32_t>> {
            if (!std::filesystem::exists(file(block))) return std::nullopt;
            try {
              const auto words = read_npy_numbers<std::int32_t>(file(block), npy_count(file(block)));
              return std::vector<std::int32_t>(words.begin(), words.end());
            } catch (const InputError&) {
              return std::nullopt;
            }
          },
          [file](std::size_t block, std::span<const std::int32_t> words) { write_npy_numbers(file(block), words); }};
}

void remove_row_blocks(const std::filesystem::path& folder, const std::vector<std::string>& keys) {
  std::error_code ignored;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    for (const std::string& key : keys) {
      if (name.starts_with(name_begin(key))) files.push_back(entry.path());
    }
  }
  for (const std::filesystem::path& file : files) std::filesystem::remove(file, ignored);
  std::filesystem::remove(folder, ignored);
}

}  // namespace patchlight
