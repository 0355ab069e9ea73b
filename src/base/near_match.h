#pragma once

#include <span>
#include <string>

namespace patchlight {

/// The word among `allowed` that `found` is most likely a slip for: the one with the fewest letters inserted, removed
/// or replaced, at most two and fewer than half of its own; the first of equals. Empty when there is none.
std::string near_match(const std::string& found, std::span<const std::string> allowed);

/// "; did you mean 'wall'?", or nothing without a near match.
std::string suggestion(const std::string& found, std::span<const std::string> allowed);

}  // namespace patchlight
