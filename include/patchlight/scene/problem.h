#pragma once

#include "patchlight/base/geometry.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// What can be wrong with a model, worst first.
enum class ProblemKind : std::uint8_t {
  no_lamp,  ///< nothing emits; a warning, as a sky or a luminaire can be added
  // Something the model means is lost.
  covered_lamp,           ///< a lamp lies under another face in the same plane
  missing_material_file,  ///< an mtllib that is nowhere
  unknown_material,       ///< a usemtl that no material file defines
  self_intersecting,      ///< a face whose outline crosses itself
  // The answer may differ from what is meant.
  left_out,             ///< the scene lacks whole objects, light sources or more than 1 % of the area of a file
  implausible_size,     ///< the unit is probably another, or sizes and numbers do not go together
  guessed_up,           ///< the upright axis is a guess, and light or sensors depend on it
  full_reflectance,     ///< a reflectance of 1: nothing is absorbed
  moved_material_file,  ///< an mtllib found at another place than it names
  no_material,          ///< faces before any usemtl
  turned_faces,         ///< faces that are turned against their neighbours
  non_planar,           ///< faces whose corners do not lie in one plane
  duplicate_faces,      ///< a face that is there already, with the same front
  overlapping_faces,    ///< faces that lie in part under another in the same plane
  // Harmless.
  little_left_out,     ///< the scene lacks some faces of a file, or things without area
  two_sided_faces,     ///< two faces at one place, back to back
  non_manifold_edges,  ///< edges of more than two faces
  zero_area,           ///< faces without area
  repeated_corners,    ///< faces that name a corner twice in a row
  welded_vertices      ///< different vertices at one place
};

/// An error loses something that the model means; a warning may make the solution wrong; a remark only tells.
enum class Severity : std::uint8_t { error, warning, remark };

/// A face as it stands in the model.
struct ProblemFace {
  std::vector<Point> corners = {};  ///< metres
  std::uint32_t file = 0;           ///< index into Scene::files
  std::uint32_t line = 0;           ///< from 1; 0 if unknown
  std::uint32_t face = 0;           ///< number of the face in the model, from 0
};

/// One kind of thing that is wrong.
struct Problem {
  ProblemKind kind = ProblemKind::no_lamp;
  std::size_t count = 0;           ///< of faces, edges, vertices, files, materials or luminaires
  std::string what;                ///< one sentence: what was found, how many, and what is done about it
  std::vector<ProblemFace> faces;  ///< those concerned, in the model's order; may be empty
  double area = 0;                 ///< m^2 of the faces, as far as their corners are known
};

/// "self_intersecting" and so on.
const char* name_of(ProblemKind kind);

/// The kind of that name; nothing where there is none.
std::optional<ProblemKind> problem_kind(std::string_view name);

/// True for problems that can make all results wrong. Commands warn of them, with --quiet too.
bool makes_results_wrong(ProblemKind kind);

/// How grave problems of a kind are.
Severity severity_of(ProblemKind kind);

/// "error", "warning" or "remark".
const char* name_of(Severity severity);

/// The problems with the worst first; those of one kind stay in order.
std::vector<Problem> worst_first(std::vector<Problem> problems);

}  // namespace patchlight
