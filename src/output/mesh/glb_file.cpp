#include "output/mesh/glb_file.h"

#include "patchlight/base/error.h"

#include "output/file/write_bytes.h"
#include "output/mesh/append_bytes.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace patchlight {
namespace {

constexpr std::uint32_t glb_magic = 0x46546C67, glb_chunk_json = 0x4E4F534A, glb_chunk_binary = 0x004E4942;

void append_chunk(std::string& bytes, std::uint32_t type, const std::string& chunk) {
  append_bytes(bytes, static_cast<std::uint32_t>(chunk.size()));
  append_bytes(bytes, type);
  bytes += chunk;
}

// To whole words.
std::string padded(std::string chunk, char with) {
  chunk.resize((chunk.size() + 3) / 4 * 4, with);
  return chunk;
}

}  // namespace

Vector y_up(const Vector& vector, const Scene& scene) {
  const bool turned = std::abs(scene.up.y()) < std::abs(scene.up.z());
  return turned ? Vector(vector.x(), vector.z(), -vector.y()) : vector;
}

void write_glb_file(const std::filesystem::path& file, const nlohmann::ordered_json& description,
                    const std::string& buffer) {
  // Bytes that are not UTF-8 are replaced.
  const std::string text =
      padded(description.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), ' ');
  const std::string binary = padded(buffer, '\0');
  const std::size_t header = 12, chunk_header = 8;
  const std::size_t size = header + chunk_header + text.size() + chunk_header + binary.size();
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw OutputError(file.string(), "needs more than the 4 GiB that a .glb can hold; expected fewer patches or .vtp");
  std::string bytes;
  bytes.reserve(size);
  append_bytes(bytes, glb_magic);
  append_bytes(bytes, std::uint32_t{2});  // version of the container
  append_bytes(bytes, static_cast<std::uint32_t>(size));
  append_chunk(bytes, glb_chunk_json, text);
  append_chunk(bytes, glb_chunk_binary, binary);
  write_bytes(file, bytes);
}

}  // namespace patchlight
