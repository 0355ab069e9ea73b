#pragma once

#include "support/scenes.h"

#include <cmath>
#include <numbers>
#include <vector>

// Walls with small openings: flat pieces that leave a known fraction of a square open.
namespace patchlight::test {

// The polygons of a partition in or close to the plane x = 1, for y and z from 0 to 2.
using Partition = std::vector<Quad>;

// The rectangle in the plane x = 1 with these bounds.
inline Quad upright(double y0, double z0, double y1, double z1) {
  return {Point(1, y0, z0), Point(1, y1, z0), Point(1, y1, z1), Point(1, y0, z1)};
}

// Upright strips with `count` slits between them that make up the fraction `open`; a half strip at either end.
inline Partition slits(int count, double open) {
  Partition strips;
  const double pitch = 2.0 / count;
  const double solid = (1 - open) * pitch;
  for (int k = 0; k <= count; ++k) {
    const double middle = k * pitch;
    strips.push_back(upright(std::max(0.0, middle - solid / 2), 0, std::min(2.0, middle + solid / 2), 2));
  }
  return strips;
}

// count x count square holes that make up the fraction `open`.
inline Partition perforated(int count, double open) {
  Partition pieces;
  const double pitch = 2.0 / count;
  const double solid = (1 - std::sqrt(open)) * pitch;
  const auto low = [&](int k) { return std::max(0.0, k * pitch - solid / 2); };
  const auto high = [&](int k) { return std::min(2.0, k * pitch + solid / 2); };
  for (int row = 0; row <= count; ++row) {
    pieces.push_back(upright(0, low(row), 2, high(row)));
    if (row == count) break;
    for (int k = 0; k <= count; ++k) pieces.push_back(upright(low(k), high(row), high(k), low(row + 1)));
  }
  return pieces;
}

// Level slats, tilted by 45 degrees: they rise away from the lit side.
inline Partition louvres(int count) {
  Partition slats;
  const double pitch = 2.0 / count;
  const double half = 0.4 * pitch;
  for (int k = 0; k < count; ++k) {
    const double z = (k + 0.5) * pitch;
    slats.push_back({Point(1 - half, 0, z - half), Point(1 + half, 0, z + half), Point(1 + half, 2, z + half),
                     Point(1 - half, 2, z - half)});
  }
  return slats;
}

// Upright bars whose width is a twentieth of the gaps between them.
inline Partition railing(int count) {
  Partition bars;
  const double pitch = 2.0 / count;
  for (int k = 0; k < count; ++k) {
    const double y = (k + 0.5) * pitch;
    bars.push_back(upright(y - pitch / 40, 0, y + pitch / 40, 2));
  }
  return bars;
}

// A closed gray room of 2 x 2 x 2 m with a partition in its middle. The wall at x = 0 emits 1 W/m^2.
inline Scene divided(const Partition& partition) {
  Scene scene = empty_scene({grey(0.5), grey(0.5, 1)});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(2, 2, 2), true);
  for (std::size_t k = 0; k < faces.size(); ++k) scene = with_quad(std::move(scene), faces[k], k == 5 ? 1 : 0);
  for (const Quad& piece : partition) scene = with_quad(std::move(scene), piece);
  return scene;
}

// Indices of the faces of divided().
inline constexpr PolygonIndex far_wall = 3;

}  // namespace patchlight::test
