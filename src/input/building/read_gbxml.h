#pragma once

#include "patchlight/scene/scene.h"

#include "input/xml_file.h"

namespace patchlight {

/// Reads a gbXML building: its surfaces with their openings cut out, in metres by its lengthUnit, and a further factor.
/// Windows are panes with the visible transmittance of their type; the other materials are those of their kind of
/// surface, with usual reflectances, which notes state. Spaces are rooms, with the names of their storeys. Fills
/// Scene::vertices, polygons, materials, groups, rooms, file, sha256, metres_per_unit, up (z) and notes. \throws
/// InputError naming the file and the line.
Scene read_gbxml(const XmlFile& xml, double factor);

}  // namespace patchlight
