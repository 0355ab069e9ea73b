#pragma once

#include "patchlight/input/read_scene.h"

#include <string>
#include <vector>

namespace patchlight {

/// Faces by the names of their object or group, or of their material; patterns with * and ?.
struct FaceChoice {
  std::vector<std::string> only;       ///< nothing else takes part; empty: all
  std::vector<std::string> leave_out;  ///< of these, what does not take part
};

/// The scene with the faces that a choice leaves, and the materials that they have; a note tells what went.
/// \throws InputError at `where`, followed by ".only" or ".leave_out", when a pattern is of no face, or no face is
/// left.
Scene with_chosen_faces(Scene scene, const FaceChoice& choice, const std::string& where);

}  // namespace patchlight
