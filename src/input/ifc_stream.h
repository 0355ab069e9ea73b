#pragma once

#include "patchlight/scene/scene.h"

#include <optional>
#include <string>
#include <string_view>

namespace patchlight {

/// The scene of the lines that ifc/read_ifc.mjs writes, of which that script has the list. Groups are elements, by
/// class, name and identifier. A transparency makes a pane. Spaces become rooms. True north is that of the file.
/// `metres_per_unit` replaces the unit that the file states. \throws InputError naming `file` when the script refuses
/// it, or the lines are damaged.
Scene scene_of_ifc_stream(std::string_view lines, const std::string& file, std::optional<double> metres_per_unit);

}  // namespace patchlight
