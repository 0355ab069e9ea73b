#pragma once

#include "patchlight/base/diagnostics.h"
#include "patchlight/scene/scene.h"

#include <set>
#include <string>
#include <vector>

namespace patchlight {

ModelFace model_face(const Scene& scene, const Polygon& polygon);

/// The area of faces, m^2; faces without known corners count 0.
double area_of(const std::vector<ModelFace>& faces);

/// True for things of a file that the scene lacks: left_out and little_left_out.
bool is_loss(DiagnosticCode code);

/// The names of objects that have polygons.
std::set<std::string> objects_with_faces(const Scene& scene);

/// "3 faces", "1 face".
std::string counted(std::size_t count, const std::string& noun);

/// "3 faces (first at room.obj:12)".
std::string listed(const Scene& scene, const std::vector<ModelFace>& faces);

}  // namespace patchlight
