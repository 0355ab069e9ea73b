#include "gather/doubtful_sensors.h"

#include <cassert>
#include <sstream>

namespace patchlight {
namespace {

constexpr std::size_t most_sentences = 5;

std::string sentence(const SensorGroup& group, std::size_t k, Standing standing) {
  std::ostringstream text;
  const Point& point = group.sensors[k].point;
  text
      << place_of(group, k) << " at " << point.x() << ", " << point.y() << ", " << point.z() << " m "
      << (standing == Standing::inside_wall
              ? "lies inside a wall, where nothing is to be read, and is left out of minimum, mean and maximum. Move "
                "it "
                "into the room"
              : "lies in a surface that it does not face along: rounding decides on which side of it. Move it away, by "
                "a millimetre or more");
  return text.str();
}

}  // namespace

std::vector<std::string> doubtful_sensors(const Scene& scene, std::span<const SensorPlace> places) {
  std::vector<std::string> sentences;
  std::size_t doubtful = 0;
  std::size_t place = 0;
  for (const SensorGroup& group : scene.sensors) {
    for (std::size_t k = 0; k < group.sensors.size(); ++k, ++place) {
      const Standing standing = places[place].standing;
      if (standing == Standing::free) continue;
      if (++doubtful <= most_sentences) sentences.push_back(sentence(group, k, standing));
    }
  }
  assert(place == places.size());
  if (doubtful > most_sentences) {
    sentences.push_back(std::to_string(doubtful - most_sentences) + " more sensors lie inside walls or in surfaces");
  }
  return sentences;
}

}  // namespace patchlight
