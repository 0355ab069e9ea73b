#include "input/texture_maps.h"

#include "input/at_line.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

namespace patchlight {
namespace {

// A place may be so far from that of the affine map: more than numbers of six digits leave open.
constexpr double same_place_when_bent = 1e-3;

// What is farther away cannot be told apart within a texel.
constexpr double farthest_place = 1e9;

// Least squares in the plane of the face: (u, v) = G q + c with q along two axes of the plane. Exact for triangles.
std::optional<TextureMap> map_of(std::span<const Point> corners, std::span<const Eigen::Vector2d> places) {
  const Vector normal = area_vector(corners);
  if (!(normal.norm() > 0)) return std::nullopt;
  Eigen::Matrix<double, 2, 3> axes;
  axes.row(0) = normal.normalized().unitOrthogonal().transpose();
  axes.row(1) = normal.normalized().cross(axes.row(0).transpose()).transpose();
  const auto count = static_cast<double>(corners.size());
  Point middle = Point::Zero();
  Eigen::Vector2d middle_place = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    middle += corners[k] / count;
    middle_place += places[k] / count;
  }
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d q = axes * (corners[k] - middle);
    squares += q * q.transpose();
    products += (places[k] - middle_place) * q.transpose();
  }
  if (!(std::abs(squares.determinant()) > 0)) return std::nullopt;
  TextureMap map;
  map.linear = products * squares.inverse() * axes;
  map.offset = middle_place - map.linear * middle;
  if (!map.linear.allFinite() || !map.offset.allFinite()) return std::nullopt;
  return map;
}

}  // namespace

std::array<Spectrum, 3> primaries_times(const Spectrum& factor) {
  return {rgb(factor[0], 0, 0), rgb(0, factor[1], 0), rgb(0, 0, factor[2])};
}

std::uint32_t MappedFaces::add(std::span<const Point> corners, std::span<const Eigen::Vector2d> places,
                               std::uint32_t line) {
  if (!(area_vector(corners).norm() > 0)) return no_texture_map;
  const bool known = places.size() == corners.size() && std::all_of(places.begin(), places.end(), [](const auto& at) {
                       return at.allFinite() && at.cwiseAbs().maxCoeff() <= farthest_place;
                     });
  const std::optional<TextureMap> map = known ? map_of(corners, places) : std::nullopt;
  if (!map) {
    count(without_, line);
    return no_texture_map;
  }
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if ((map->linear * corners[k] + map->offset - places[k]).norm() <= same_place_when_bent) continue;
    count(bent_, line);
    break;
  }
  maps_.push_back(*map);
  return static_cast<std::uint32_t>(maps_.size() - 1);
}

void MappedFaces::count(Faces& faces, std::uint32_t line) {
  if (faces.count++ == 0) faces.first_line = line;
}

std::string MappedFaces::sentence(const Faces& faces, const std::string& what) const {
  const std::string first = faces.first_line > 0 ? " (first at " + at_line(file_, faces.first_line) + ")" : "";
  return what + ": " + std::to_string(faces.count) + first;
}

Diagnostics MappedFaces::notes() const {
  Diagnostics notes;
  if (without_.count > 0)
    notes.push_back({DiagnosticCode::simplified_picture,
                     sentence(without_, "faces whose corners have no good place in their picture, whose mean counts")});
  if (bent_.count > 0)
    notes.push_back({DiagnosticCode::simplified_picture,
                     sentence(bent_, "faces over which a picture is bent, which is taken as straight")});
  return notes;
}

}  // namespace patchlight
