#pragma once

#include "patchlight/scene/scene.h"

#include <cstddef>
#include <string>
#include <vector>

namespace patchlight {

/// Per polygon whether its object, its group or its file bears this name or matches it as a pattern with * and ?; a
/// file by the last part of its path, or by the whole of it without a pattern. \throws InputError at `where` when that
/// is none.
std::vector<bool> faces_of(const Scene& scene, const std::string& pattern, const std::string& where);

/// The materials of these polygons, in order.
std::vector<std::size_t> materials_of(const Scene& scene, const std::vector<bool>& polygons);

/// A scene in which these polygons share these of their materials with no others.
struct OwnMaterials {
  Scene scene;
  std::vector<std::size_t> materials;  ///< in the place of those given
};

/// Gives the polygons copies of materials that others have as well, named after `of`: "Concrete of IfcSlab*".
OwnMaterials with_own_materials(Scene scene, const std::vector<bool>& polygons, std::vector<std::size_t> materials,
                                const std::string& of);

}  // namespace patchlight
