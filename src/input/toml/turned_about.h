#pragma once

#include "patchlight/base/geometry.h"

namespace patchlight {

/// The rotation about a unit vector, anticlockwise seen from its tip; exact for quarter turns about an axis.
Eigen::Matrix3d turned_about(const Vector& axis, double degrees);

}  // namespace patchlight
