#include "input/read_ifc.h"

#include "files/sha256.h"
#include "input/assimp_scene.h"
#include "input/ifc_voids.h"
#include "input/isolated.h"
#include "input/materials.h"
#include "input/text.h"

#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

// assimp turns z up into y up by -90 degrees about x, rounded to single precision; this is the way back, with the same
// rounding.
Eigen::Matrix3d back_to_z_up() {
  const float angle = std::numbers::pi_v<float> / 2;
  const double cosine = std::cos(angle);
  const double sine = std::sin(angle);
  Eigen::Matrix3d turn;
  turn << 1, 0, 0, 0, cosine, -sine, 0, sine, cosine;
  return turn;
}

std::string note_on_voids(std::size_t profiles) {
  return std::to_string(profiles) + (profiles == 1 ? " profile has" : " profiles have") +
         " voids that are no polygons within it, which are not cut: frames made of them are read as boards";
}

}  // namespace

Scene read_ifc(const std::filesystem::path& file, double metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  AssimpFormat format;
  format.extension = "ifc";
  format.turn = back_to_z_up();
  Scene scene = read_isolated(file.string(), [&] {
    const JoinedVoids joined = with_joined_voids(bytes);
    format.has_seams = joined.joined > 0;
    Scene read = with_used_materials(assimp_scene(joined.text, file.string(), format, metres_per_unit));
    if (joined.left > 0) read.notes.push_back(note_on_voids(joined.left));
    return read;
  });
  scene.up = Vector::UnitZ();
  scene.up_stated = true;
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

}  // namespace patchlight
