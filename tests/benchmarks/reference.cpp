#include "benchmarks/reference.h"

#include "patchlight/base/error.h"
#include "patchlight/transport/assemble.h"

#include "transport/tiles.h"
#include "visibility/occluder.h"

#include <fstream>

namespace patchlight::benchmarks {
namespace {

constexpr std::uint64_t seed = 7;

std::streamsize bytes(std::span<const float> tile) { return static_cast<std::streamsize>(tile.size_bytes()); }

ExchangeAreas read_matrix(const std::filesystem::path& file, PatchIndex size) {
  if (std::filesystem::file_size(file) != ExchangeAreas::bytes(size)) {
    throw InputError(file.string(), "this is the reference of another mesh; remove it to have it made again");
  }
  ExchangeAreas S(size);
  std::ifstream in(file, std::ios::binary);
  for (PatchIndex I = 0; I < Tiles::blocks(S); ++I) {
    for (PatchIndex J = I; J < Tiles::blocks(S); ++J) {
      const std::span<float> tile = Tiles::of(S, I, J);
      in.read(reinterpret_cast<char*>(tile.data()), bytes(tile));
    }
  }
  if (!in) throw InputError(file.string(), "the reference cannot be read");
  return S;
}

void write_matrix(const ExchangeAreas& S, const std::filesystem::path& file) {
  // Under another name first: what is there under its own is whole.
  const std::filesystem::path partial = file.string() + ".part";
  std::ofstream out(partial, std::ios::binary);
  for (PatchIndex I = 0; I < Tiles::blocks(S); ++I) {
    for (PatchIndex J = I; J < Tiles::blocks(S); ++J) {
      const std::span<const float> tile = Tiles::of(S, I, J);
      out.write(reinterpret_cast<const char*>(tile.data()), bytes(tile));
    }
  }
  out.close();
  if (!out) throw InputError(file.string(), "the reference cannot be written");
  std::filesystem::rename(partial, file);
}

}  // namespace

ExchangeAreas reference(const Room& room, int samples, const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) return read_matrix(file, room.mesh.size());
  Assembly assembly = assemble_exchange_areas(room.mesh, Occluder(room.scene), {samples, seed});
  write_matrix(assembly.exchange_areas, file);
  return std::move(assembly.exchange_areas);
}

}  // namespace patchlight::benchmarks
