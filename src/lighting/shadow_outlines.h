#pragma once

#include "patchlight/base/geometry.h"

#include "lighting/lit_area.h"
#include "lighting/receiver.h"
#include "scene/light_place.h"
#include "visibility/shaft.h"

#include <array>
#include <span>
#include <vector>

namespace patchlight {

/// The plane of a patch with two axes.
struct ShadowFrame {
  Point origin;
  Vector u, v, normal;

  Eigen::Vector2d in_plane(const Point& point) const { return {u.dot(point - origin), v.dot(point - origin)}; }
};

ShadowFrame shadow_frame_of(const Receiver& patch);

/// Of points in the plane, counter-clockwise in the frame.
Outline outline_of(std::span<const Point> corners, const ShadowFrame& frame);

/// True when all of a region lies within an outline.
bool holds(const Outline& outline, const Outline& region);

/// The part of a triangle between a frame's plane and the light; nothing of one that does not rise higher than `least`.
std::vector<Point> part_above(const std::array<Point, 3>& triangle, const ShadowFrame& frame, double least,
                              const LightPlace& light);

/// What lies outside one of these half spaces cannot stand between the patch and the light.
std::vector<HalfSpace> shaft_of(const Receiver& patch, const ShadowFrame& frame, const LightPlace& light);

}  // namespace patchlight
