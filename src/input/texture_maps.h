#pragma once

#include "patchlight/scene/scene.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// What a picture of 1 in red, in green and in blue alone reflects when it is multiplied with a colour of three bands.
std::array<Spectrum, 3> primaries_times(const Spectrum& factor);

/// The maps of faces into pictures, one after the other, and what is wrong with them.
class MappedFaces {
 public:
  explicit MappedFaces(std::string file) : file_(std::move(file)) {}

  /// The index of a new map for a face with these corners, m, which lie there in its picture; that of the affine map
  /// that comes nearest, where it has more than three corners. no_texture_map for a face without area, and for one
  /// whose places are not known: there are none, or they are not finite. `line` 0: not known.
  std::uint32_t add(std::span<const Point> corners, std::span<const Eigen::Vector2d> places, std::uint32_t line);

  const std::vector<TextureMap>& maps() const { return maps_; }

  /// How many faces have no place in their picture, or a bent one, and which is the first.
  Diagnostics notes() const;

 private:
  struct Faces {
    std::size_t count = 0;
    std::uint32_t first_line = 0;
  };
  static void count(Faces& faces, std::uint32_t line);
  std::string sentence(const Faces& faces, const std::string& what) const;

  std::string file_;
  std::vector<TextureMap> maps_;
  Faces without_;
  Faces bent_;
};

}  // namespace patchlight
