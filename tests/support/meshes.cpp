#include "meshes.h"

namespace patchlight {

std::filesystem::path mesh_folder() { return PATCHLIGHT_MESHES; }

}  // namespace patchlight
