#include "plan/fine_outlines.h"

#include "mesh/coarse_outline.h"
#include "mesh/mesher.h"
#include "scene/problem_face.h"

#include <algorithm>
#include <sstream>

namespace patchlight {
namespace {

std::string note_on_coarse(const std::string& faces, std::size_t corners, std::size_t left_out, double max_edge) {
  std::ostringstream text;
  text.precision(2);
  text << faces << " with an outline of up to " << corners
       << " corners, finer than the patches: these follow one of the same area without up to " << left_out
       << " of them, nowhere farther away than " << outline_tolerance * max_edge << " m";
  return text.str();
}

std::string note_on_kept(const std::string& faces, std::size_t corners) {
  return faces + " with an outline of up to " + std::to_string(corners) +
         " corners where other faces meet it or it turns, finer than the patches asked for: these are kept, so that "
         "each side takes " +
         std::to_string(corners - 2) + " patches at least; an outline of fewer corners takes fewer";
}

}  // namespace

std::vector<std::string> notes_on_fine_outlines(const Scene& scene, const KeptSides& sides, std::size_t asked,
                                                double max_edge) {
  constexpr std::size_t parts = 4;  // of the patches asked for: a face that takes as many is worth a word
  constexpr std::size_t few = 24;   // corners that a round face keeps however large patches are
  const std::vector<std::size_t> left_out = left_out_corners(scene, max_edge);
  std::vector<ProblemFace> coarse, kept;
  std::size_t most = 0, most_left_out = 0, most_kept = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::size_t corners = scene.polygons[p].corners.size();
    if (!(sides.front[p] || sides.back[p]) || corners <= 4) continue;
    const auto face = [&] { return problem_face(scene, scene.polygons[p]); };
    if (left_out[p] > 0) {
      coarse.push_back(face());
      most = std::max(most, corners);
      most_left_out = std::max(most_left_out, left_out[p]);
    }
    if (asked == 0 || parts * (corners - left_out[p] - 2) < asked) continue;
    if (left_out[p] > 0 && corners - left_out[p] <= few) continue;
    kept.push_back(face());
    most_kept = std::max(most_kept, corners - left_out[p]);
  }
  std::vector<std::string> notes;
  if (!coarse.empty()) notes.push_back(note_on_coarse(listed(scene, coarse), most, most_left_out, max_edge));
  if (!kept.empty()) notes.push_back(note_on_kept(listed(scene, kept), most_kept));
  return notes;
}

}  // namespace patchlight
