#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// True when a word of the name is one for a lamp: "ceiling_light", "FloorLamp 2", "Deckenleuchte". Words end at
/// letters that are none, at digits, and where a capital follows a small letter. "Lightweight" is another word, and
/// "light grey" a colour.
bool is_name_of_lamp(const std::string& name);

/// "a, b, c" of up to `few` names, "and 3 more" of the rest.
std::string first_few(std::span<const std::string> names, std::size_t few = 8);

/// The area of all polygons, each once, m^2.
double area_of_faces(const Scene& scene);

/// What lights a scene in which nothing emits.
struct FirstLight {
  std::string setting;  ///< of a request, as read.daylight.sky=overcast:10000lx; empty: it takes a scene file
  std::string advice;   ///< all that can light it, `setting` among it, a problem and a "hint: " line for each remedy
};

/// Of a room that no daylight gets into, sealed_hull(), the material that looks like a lamp, or a luminaire in a scene
/// file where none does; of other scenes the sky. The advice names materials that look like lamps with the settings
/// that switch them on, and where daylight and luminaires are described. O(n log n) for n corners.
FirstLight first_light(const Scene& scene);

/// What of a scene is made of one material.
struct MaterialFacts {
  Material material;
  std::size_t faces = 0;
  double area = 0;  ///< m^2, of the sides that have this material: backs count only where they have one of their own
  Spectrum flux;    ///< W, emitted by these sides
  double luminous_flux = 0;  ///< lm, of all bands
};

/// Faces of one object or group, or of one class of objects: those of an IFC file with names that begin alike.
struct ObjectFacts {
  std::string name;         ///< or a pattern: "IfcSlab_*" for a class
  std::size_t objects = 1;  ///< of the class
  std::size_t faces = 0;
  double area = 0;  ///< m^2
};

/// A unit that makes a model of implausible size plausible.
struct UnitGuess {
  std::string unit;  ///< m, cm, mm, in or ft
  double metres_per_unit = 1;
  std::string reason;
};

/// The sides of polygons that take part in a solve.
struct SideCounts {
  Sides chosen = Sides::automatic;
  std::size_t kept = 0;  ///< of twice as many as there are polygons
  double area = 0;       ///< m^2
  Diagnostics notes;     ///< what was left out, and why
};

/// What a scene holds and what is wrong with it.
struct SceneReport {
  Box bounds;  ///< metres
  std::size_t vertices = 0;
  std::size_t polygons = 0;
  std::size_t groups = 0;
  double area = 0;                       ///< m^2, each polygon once
  std::vector<MaterialFacts> materials;  ///< those that faces have, in the scene's order
  std::vector<ObjectFacts> objects;      ///< or groups, the largest first
  std::vector<ObjectFacts> classes;      ///< the same with the objects of an IFC class as one
  std::size_t lamps = 0;                 ///< emitting polygons
  std::size_t shells = 0;                ///< sets of polygons connected by shared edges
  std::size_t closed_shells = 0;
  std::size_t open_edges = 0;   ///< edges of one polygon only: the rims of openings and of sheets
  double open_edge_length = 0;  ///< metres
  Diagnostics diagnostics;      ///< those of the scene and those found here, worst first
  std::optional<UnitGuess> unit_guess;
  std::optional<SideCounts> sides = {};        ///< when they are counted: count_sides()
  bool usable = true;                          ///< false when nothing emits: it cannot be solved
  std::optional<FirstLight> first_light = {};  ///< what would light a scene in which nothing emits
};

/// Looks at a scene that repair() and check() have passed. Pure. O(n log n) for n corners.
SceneReport survey(const Scene& scene);

/// That a model is smaller than 0.4 m or larger than 150 m, what is far from the rest apart, with the unit that would
/// make it the size of a room; and what problems_with_luminaires() tells. Nothing for others.
Diagnostics problems_with_size(const Scene& scene);

/// That more than 100,000 sensors are asked for. Nothing for fewer.
Diagnostics problems_with_sensors(const Scene& scene);

/// The sky's kind as in a scene file.
const char* name_of(SkyKind kind);

/// How many sides are kept.
std::size_t kept_side_count(const KeptSides& sides);

/// The sides that kept_sides() chooses; all that can be said of a scene without a lamp is which are fronts.
SideCounts count_sides(const Scene& scene, Sides sides);

}  // namespace patchlight
