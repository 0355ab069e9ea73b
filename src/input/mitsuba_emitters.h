#pragma once

#include "patchlight/scene/scene.h"

#include "input/mitsuba_file.h"

namespace patchlight {

/// The scene with an emitter that is no surface: constant light from all around is an even sky and ground, a point
/// light a luminaire, a directional one the sun. Notes name others, and what to do for a sky. \throws InputError naming
/// the line.
Scene with_mitsuba_emitter(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter);

/// The scene with the view of a perspective sensor, if it is one.
Scene with_mitsuba_sensor(Scene scene, const MitsubaFile& file, const pugi::xml_node& sensor);

/// The radiance that the area emitter of a shape has; black without one. \throws InputError naming the line.
Spectrum emitted_radiance(const MitsubaFile& file, const pugi::xml_node& shape);

}  // namespace patchlight
