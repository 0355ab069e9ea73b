#include "input/read_stl.h"

#include "input/assimp_scene.h"
#include "input/isolated.h"
#include "input/sha256.h"
#include "input/text.h"

namespace patchlight {

Scene read_stl(const std::filesystem::path& file, double metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  AssimpFormat format;
  format.extension = "stl";
  format.has_materials = false;
  Scene scene =
      read_isolated(file.string(), [&] { return assimp_scene(bytes, file.string(), format, metres_per_unit); });
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

}  // namespace patchlight
