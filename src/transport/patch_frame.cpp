#include "transport/patch_frame.h"

#include <Eigen/Geometry>

namespace patchlight {

Eigen::Matrix3d patch_frame(const PatchMesh& mesh, PatchIndex patch) {
  const PatchCorners corners = mesh.corner_points(patch);
  Eigen::Matrix3d frame;
  frame.col(2) = mesh.normal[patch];
  frame.col(1) = frame.col(2).cross(corners.points[1] - corners.points[0]).normalized();
  frame.col(0) = frame.col(1).cross(frame.col(2));
  return frame;
}

}  // namespace patchlight
