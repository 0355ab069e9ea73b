#pragma once

#include "patchlight/scene/scene.h"

#include <string>
#include <string_view>

namespace patchlight {

/// The scene of the lines that ifc/read_ifc.mjs writes, of which that script has the list. Groups are elements, by
/// class, name and identifier. A transparency makes a pane. Spaces become rooms. True north is that of the file.
/// Lengths are multiplied by `scale`. \throws InputError naming `file` when the script refuses it, or the lines are
/// damaged.
Scene scene_of_ifc_stream(std::string_view lines, const std::string& file, double scale);

}  // namespace patchlight
