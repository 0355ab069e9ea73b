#pragma once

#include "patchlight/scene/problem.h"
#include "patchlight/scene/scene.h"

#include <string>
#include <vector>

namespace patchlight {

ProblemFace problem_face(const Scene& scene, const Polygon& polygon);

/// "3 faces", "1 face".
std::string counted(std::size_t count, const std::string& noun);

/// "3 faces (first at room.obj:12)".
std::string listed(const Scene& scene, const std::vector<ProblemFace>& faces);

}  // namespace patchlight
