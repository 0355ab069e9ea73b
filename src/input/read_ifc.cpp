#include "input/read_ifc.h"

#include "input/assimp_scene.h"
#include "input/isolated.h"
#include "input/sha256.h"
#include "input/text.h"

namespace patchlight {

Scene read_ifc(const std::filesystem::path& file, double metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  AssimpFormat format;
  format.extension = "ifc";
  // assimp turns z up into y up, (x, y, z) to (x, z, -y); this is the way back.
  format.turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  Scene scene =
      read_isolated(file.string(), [&] { return assimp_scene(bytes, file.string(), format, metres_per_unit); });
  scene.up = Vector::UnitZ();
  scene.up_stated = true;
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

}  // namespace patchlight
