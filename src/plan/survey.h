#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// True when a word of the name denotes a lamp: "ceiling_light", "FloorLamp 2", "Deckenleuchte". Words end at
/// characters other than letters, and where a capital follows a small letter. "Lightweight" is another word, and "light
/// gray" is a color.
bool is_name_of_lamp(const std::string& name);

/// The area of all polygons, each once, m^2.
double area_of_faces(const Scene& scene);

/// A first light for a scene in which nothing emits.
struct FirstLight {
  std::string setting;  ///< of a request, e.g. read.daylight.sky=overcast:10000lx; empty: a scene file is needed
  std::string advice;   ///< the problem, and a "hint: " line for each remedy, with `setting` among them
};

/// Suggests a light for the scene. For a room without daylight, sealed_hull(), it is the material that looks like a
/// lamp, or else a luminaire in a scene file. For other scenes it is the sky. The advice names materials that look like
/// lamps and the settings that switch them on. O(n log n) for n corners.
FirstLight first_light(const Scene& scene);

/// The faces of a scene with one material.
struct MaterialFacts {
  Material material;
  std::size_t faces = 0;
  double area = 0;  ///< m^2, of the sides that have this material: backs count only where they have one of their own
  Spectrum flux;    ///< W, emitted by these sides
  double luminous_flux = 0;  ///< lm, of all bands
};

/// The faces of one object or group, or of one class: the objects of an IFC file whose names begin alike.
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

/// The sides of polygons that are included in a solve.
struct SideCounts {
  Sides chosen = Sides::automatic;
  std::size_t kept = 0;  ///< out of two per polygon
  double area = 0;       ///< m^2
  Diagnostics notes;     ///< the sides left out, with reasons
};

/// The contents of a scene and its defects.
struct SceneReport {
  Box bounds;  ///< meters
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
  double open_edge_length = 0;  ///< meters
  Diagnostics diagnostics;      ///< those of the scene and those found here, worst first
  std::optional<UnitGuess> unit_guess;
  std::optional<SideCounts> sides = {};        ///< when they are counted: count_sides()
  bool usable = true;                          ///< false when nothing emits: it cannot be solved
  std::optional<FirstLight> first_light = {};  ///< what would light a scene in which nothing emits
};

/// Surveys a scene that repair() and check() have processed. Pure. O(n log n) for n corners.
SceneReport survey(const Scene& scene);

/// Warns about a model smaller than 0.4 m or larger than 150 m, outliers excluded, with the unit that would give it the
/// size of a room. Includes problems_with_luminaires(). Empty for other models.
Diagnostics problems_with_size(const Scene& scene);

/// Warns about more than 100,000 sensors. Empty for fewer.
Diagnostics problems_with_sensors(const Scene& scene);

/// The sky's kind as in a scene file.
const char* name_of(SkyKind kind);

/// The number of kept sides.
std::size_t kept_side_count(const KeptSides& sides);

/// Counts the sides that kept_sides() chooses. In a scene without a lamp only the fronts can be determined.
SideCounts count_sides(const Scene& scene, Sides sides);

}  // namespace patchlight
