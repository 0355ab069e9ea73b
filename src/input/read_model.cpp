#include "input/read_model.h"

#include "patchlight/base/error.h"
#include "patchlight/input/read_scene.h"

#include "input/read_collada.h"
#include "input/read_gltf.h"
#include "input/read_ifc.h"
#include "input/read_obj.h"
#include "input/read_off.h"
#include "input/read_ply.h"
#include "input/read_stl.h"

#include <algorithm>
#include <cctype>
#include <system_error>

namespace patchlight {
namespace {

// ".obj, .ply, ..."
std::string allowed_extensions() {
  std::string list;
  for (const std::string& format : readable_formats()) list += (list.empty() ? "." : ", .") + format;
  return list;
}

}  // namespace

std::string format_of(const std::filesystem::path& file) {
  if (file == "-") return "obj";
  std::string text = file.extension().string();
  if (!text.empty()) text.erase(0, 1);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

void require_file(const std::filesystem::path& file, const std::string& where) {
  if (file == "-") return;
  std::error_code error;
  const std::string name = where == file ? "" : file.string() + ": ";
  if (!std::filesystem::exists(file, error)) {
    throw InputError(where, name + "the model file does not exist; check the name and the folder");
  }
  if (std::filesystem::is_directory(file, error)) {
    throw InputError(where, name + "this is a folder; expected a model file (" + allowed_extensions() + ")");
  }
}

Scene read_model(const std::filesystem::path& file, const std::string& format, double metres_per_unit) {
  if (format == "obj") return read_obj(file, metres_per_unit);
  if (format == "ply") return read_ply(file, metres_per_unit);
  if (format == "stl") return read_stl(file, metres_per_unit);
  if (format == "off") return read_off(file, metres_per_unit);
  if (format == "dae") return read_collada(file, metres_per_unit);
  if (format == "ifc") return read_ifc(file, metres_per_unit);
  if (format == "gltf" || format == "glb") return read_gltf(file, metres_per_unit);
  throw InputError(file.string(),
                   "the extension '." + format + "' is not known; expected one of " + allowed_extensions());
}

}  // namespace patchlight
