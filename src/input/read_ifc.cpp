#include "input/read_ifc.h"

#include "patchlight/base/error.h"

#include "files/isolated.h"
#include "files/sha256.h"
#include "input/ifc_stream.h"
#include "input/share_folder.h"
#include "input/text.h"

#include <cstdlib>
#include <sstream>
#include <system_error>
#include <unistd.h>

namespace patchlight {
namespace {

namespace fs = std::filesystem;

// The file of a program that PATH finds; empty when there is none.
fs::path program_file(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::error_code error;
    fs::path file = fs::canonical(fs::path(folder) / name, error);
    if (!error && fs::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

// Node.js with the script that reads IFC by web-ifc, a package beside the script.
Program ifc_reader(const std::string& file) {
  const fs::path node = program_file("node");
  if (node.empty()) {
    throw InputError(file,
                     "IFC files need Node.js, which is not installed; run scripts/install_packages.sh of patchlight "
                     "or install the package nodejs");
  }
  const fs::path script = shared_file("ifc/read_ifc.mjs");
  if (script.empty() || !fs::exists(script.parent_path() / "node_modules/web-ifc/web-ifc-node.wasm")) {
    throw InputError(file,
                     "IFC files need the package web-ifc, which is not installed; run "
                     "scripts/install_packages.sh of patchlight");
  }
  return {{node, script}, {node.parent_path().parent_path(), script.parent_path()}};
}

}  // namespace

Scene read_ifc(const fs::path& file, std::optional<double> metres_per_unit) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  const std::string lines = output_isolated(file.string(), ifc_reader(file.string()), bytes);
  Scene scene = scene_of_ifc_stream(lines, file.string(), metres_per_unit);
  scene.metres_per_unit = metres_per_unit.value_or(1);
  scene.unit_stated = !metres_per_unit;
  scene.up = Vector::UnitZ();
  scene.up_stated = true;
  scene.sha256 = sha256({&bytes, 1});
  return scene;
}

}  // namespace patchlight
