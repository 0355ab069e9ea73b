#pragma once

#include "patchlight/scene/problem.h"

#include "input/read_mtl.h"
#include "input/scan_obj.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight {

/// What the mtllib statements of an OBJ file bring.
struct Libraries {
  std::vector<MtlMaterial> materials;        ///< of those with the same name only the first counts
  std::vector<std::string> texts;            ///< the files' bytes, for the checksum
  std::vector<std::filesystem::path> files;  ///< the files, and the textures that they name
  std::vector<Problem> problems;  ///< files that are missing, or beside the model instead of where they should be
};

/// Reads the files that the statements name. A file that is not where its name says is looked for beside the model,
/// under the last part of its name, in capitals or not. \throws InputError when one cannot be read, or does not
/// lie in the folder `confine`, if there is one.
Libraries read_libraries(const std::filesystem::path& obj, const std::vector<ObjName>& statements,
                         const std::filesystem::path& confine);

}  // namespace patchlight
