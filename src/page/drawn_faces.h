#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/views/views.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// Base64 (RFC 4648, section 4).
std::string base64(std::string_view bytes);

/// Numbers of `width` bytes each as text: first the lowest byte of all, then the next, so that bytes that are alike
/// stand together; deflated in the format of zlib (RFC 1950), in base64.
std::string packed_text(std::string_view bytes, std::size_t width);

/// An array for the page: {"type": "f4", "components": 3, "packed": text}. Types are u1, u2, u4 and f4, little endian.
template <class Number>
nlohmann::ordered_json packed_array(std::span<const Number> values, std::size_t components) {
  const char kind = std::is_floating_point_v<Number> ? 'f' : 'u';
  const std::string_view bytes{reinterpret_cast<const char*>(values.data()), values.size_bytes()};
  return {{"type", std::string(1, kind) + std::to_string(sizeof(Number))},
          {"components", components},
          {"packed", packed_text(bytes, sizeof(Number))}};
}

/// A solved surface as a page draws it. A row has the values of one patch, or the means over all patches of one side
/// of a polygon, where there are too many.
struct DrawnFaces {
  std::vector<Point> vertices;                        ///< meters
  std::vector<std::array<std::uint8_t, 3>> colours;   ///< per vertex: as it looks, sRGB
  std::vector<std::array<std::uint32_t, 4>> corners;  ///< per face, counter-clockwise; a triangle repeats its last
  std::vector<std::uint32_t> row;                     ///< per face
  std::vector<PatchRange> patches;                    ///< per row
  std::size_t left_out = 0;                           ///< patches of the smallest faces, which are not drawn
  std::size_t covered = 0;                            ///< patches that lie wholly under other faces: not drawn either
};

/// The faces of a surface that can be seen, at most `most` of them: patches, and where these are too many, whole sides
/// of polygons in place of those patches that differ least from their mean, at last without the smallest. Colors are
/// those of `exposure`. O(n log n).
DrawnFaces drawn_faces(const SolvedSurface& surface, double exposure, std::size_t most);

/// A way to draw a model as it looks.
struct Look {
  const char* name;
  double exposure = 1;  ///< see Picture::exposure
};

/// The exposures of a page's model. The first is `exposure`. If both enclosed and other patches are lit by day, a
/// second exposure serves the part for which the first is not made.
std::vector<Look> looks_of(const SolvedSurface& surface, double exposure);

/// Per look its name, exposure and colors per vertex of at most `most_faces` faces (drawn_faces()), and where there is
/// a sky the colors of sky and ground in the directions of sky_directions().
nlohmann::ordered_json looks_part(const SolvedSurface& surface, double exposure, std::size_t most_faces);

/// Unit directions from the nadir to the zenith, ring by ring, with the number of directions in a ring; null without a
/// sky.
nlohmann::ordered_json sky_directions(const SolvedSurface& surface);

}  // namespace patchlight
