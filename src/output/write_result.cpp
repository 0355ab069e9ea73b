#include "patchlight/output/write_result.h"

#include "patchlight/base/error.h"
#include "patchlight/output/provenance.h"

#include "output/mesh/write_mesh.h"
#include "output/vtk/write_vtk.h"

namespace patchlight {

const char* version() { return PATCHLIGHT_VERSION; }

const std::vector<std::string>& result_extensions() {
  static const std::vector<std::string> extensions = {".vtp", ".vtu", ".ply", ".glb"};
  return extensions;
}

void write_result(const std::filesystem::path& file, const SolvedSurface& surface, const Provenance& provenance) {
  const std::string extension = file.extension().string();
  if (extension == ".vtp" || extension == ".vtu") return write_vtk(file, surface, provenance);
  if (extension == ".ply") return write_ply(file, surface, provenance);
  if (extension == ".glb") return write_glb(file, surface, provenance);
  throw OutputError(file.string(), "the extension names no known format; expected .vtp, .vtu, .ply or .glb");
}

}  // namespace patchlight
