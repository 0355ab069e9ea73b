#pragma once

#include "patchlight/base/geometry.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// The findings on a model, its plan and its run, worst first. docs/reference/diagnostics.md lists them.
enum class DiagnosticCode : std::uint8_t {
  no_lamp,  ///< nothing emits; a warning, as a sky or a luminaire can be added
  // Errors: something the model means is lost.
  covered_lamp,           ///< a lamp lies under another face in the same plane
  missing_material_file,  ///< an mtllib that is nowhere
  unknown_material,       ///< a usemtl that no material file defines
  self_intersecting,      ///< a face whose outline crosses itself
  // Warnings: the answer may differ from the intention.
  left_out,             ///< the scene lacks whole objects, light sources or more than 1 % of the area of a file
  implausible_size,     ///< the unit is probably another, or sizes and numbers do not go together
  guessed_up,           ///< the upright axis is a guess, and light or sensors depend on it
  full_reflectance,     ///< a reflectance of 1: nothing is absorbed
  moved_material_file,  ///< an mtllib found at another place than it names
  no_material,          ///< faces before any usemtl
  turned_faces,         ///< faces that are turned against their neighbors
  non_planar,           ///< faces whose corners do not lie in one plane
  duplicate_faces,      ///< a face that is there already, with the same front
  overlapping_faces,    ///< faces that lie in part under another in the same plane
  misplaced_luminaire,  ///< luminaires behind a face, in its plane, or just outside of a room
  doubtful_sensor,      ///< sensors inside walls, in surfaces, far from the model or close to pictures
  // Remarks: harmless.
  little_left_out,     ///< the scene lacks some faces of a file, or things without area
  two_sided_faces,     ///< two faces at one place, back to back
  non_manifold_edges,  ///< edges of more than two faces
  zero_area,           ///< faces without area
  repeated_corners,    ///< faces that name a corner twice in a row
  welded_vertices,     ///< different vertices at one place
  // Notes on the model.
  reduced_model,        ///< faces are excluded, or small bodies simplified, as asked
  maintenance_factor,   ///< lamps and luminaires are dimmed by it, as asked
  assumed_material,     ///< values for which the file states none, or none that is plausible
  simplified_part,      ///< materials, shapes and other parts of a file that are ignored or approximated
  cut_out_material,     ///< holes that pictures cut out count by their share of the area
  unreadable_picture,   ///< a picture of a material that cannot be read
  simplified_picture,   ///< pictures count by their mean color, or are straightened
  read_as_pane,         ///< materials that let light through, and pairs of faces that are one pane
  read_as_mirror,       ///< materials that reflect light without scattering it
  lowered_reflectance,  ///< reflectances that exceed 1 together with other shares
  simplified_light,     ///< light that the scene holds in another form than it is stated
  renamed_material,     ///< materials of several files with one name
  north_of_file,        ///< the direction of north that a file states
  missing_sensors,      ///< rooms without sensors, or with sensors over a part of the floor
  // Notes on the plan and the run.
  unlit_sides,            ///< sides that are excluded, as no light reaches them
  sealed_solid,           ///< closed solids around lamps that daylight does not enter
  outward_normals,        ///< closed solids around lamps whose inner sides are backs
  both_sides,             ///< both sides of faces emit, or share a form factor
  sun_below_horizon,      ///< the sun gives no light
  idle_option,            ///< an option on an effect of which the scene has nothing
  translucent_sheet,      ///< faces that need a solver for sheets
  contact_lines,          ///< lines at which patches end, or do not
  shadow_edges,           ///< edges of hard shadows at which patches end, or do not
  fine_outline,           ///< outlines that are finer than patches
  more_patches,           ///< the faces take more patches than asked for
  rows_of_rays,           ///< form factors are sampled by rays
  second_mesh,            ///< a second mesh is made, or does not fit into the memory
  unfollowed_reflection,  ///< light by mirrors and glazing that is not followed
  close_lamp,             ///< lamps nearer to a surface than its patches are large
  lost_light,             ///< light that is lost, as the form factors were made for other lamps
  checkpoint              ///< rows taken from a checkpoint, or kept in one
};

/// An error loses something that the model means; a warning may make the solution wrong; a remark names a harmless
/// defect; a note states an assumption or a decision.
enum class Severity : std::uint8_t { error, warning, remark, note };

/// A face as it stands in the model.
struct ModelFace {
  std::vector<Point> corners = {};  ///< meters
  std::uint32_t file = 0;           ///< index into Scene::files
  std::uint32_t line = 0;           ///< from 1; 0 if unknown
  std::uint32_t face = 0;           ///< number of the face in the model, from 0
};

/// One finding.
struct Diagnostic {
  DiagnosticCode code = DiagnosticCode::no_lamp;
  std::string text = {};              ///< one sentence: the finding, how many, and the action
  std::size_t count = 1;              ///< of faces, edges, vertices, files, materials or luminaires
  std::vector<ModelFace> faces = {};  ///< those concerned, in the model's order; may be empty
  double area = 0;                    ///< m^2 of the faces, as far as their corners are known
};

/// Findings in the order in which they were made.
using Diagnostics = std::vector<Diagnostic>;

/// "self_intersecting" and so on.
const std::string& name_of(DiagnosticCode code);

/// The code of that name; nothing where there is none.
std::optional<DiagnosticCode> diagnostic_code(std::string_view name);

/// True for findings that can make all results wrong. Commands warn of them, with --quiet too.
bool makes_results_wrong(DiagnosticCode code);

/// How grave findings of a code are.
Severity severity_of(DiagnosticCode code);

/// True for codes of Severity::note.
bool is_note(DiagnosticCode code);

/// "error", "warning", "remark" or "note".
const char* name_of(Severity severity);

/// The diagnostics with the worst first; those of one code stay in order.
Diagnostics worst_first(Diagnostics diagnostics);

/// Those with codes for which this is true.
Diagnostics chosen(Diagnostics all, bool (*is_chosen)(DiagnosticCode));

/// The lists one after the other.
Diagnostics merged(std::vector<Diagnostics> lists);

/// The texts alone.
std::vector<std::string> texts_of(const Diagnostics& diagnostics);

}  // namespace patchlight
