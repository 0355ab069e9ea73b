#include "validate/validate.h"

#include "patchlight/base/error.h"

#include "validate/cases.h"

#include <cmath>

namespace patchlight {

bool within_bar(const ValidationResult& result) {
  return std::abs(result.measured.value - result.exact) <= result.measured.error_bar;
}

std::vector<ValidationCase> validation_cases() {
  std::vector<ValidationCase> all = validation::rectangle_cases();
  for (const auto& more : {validation::curved_cases(), validation::solved_cases()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

std::vector<ValidationResult> validate(std::span<const ValidationCase> cases, const Observer& observer) {
  std::vector<ValidationResult> results;
  for (const ValidationCase& one : cases) {
    if (observer && !observer({.stage = Stage::form_factors})) throw Cancelled();
    results.push_back({one.name, one.exact, one.source, one.measure(observer)});
  }
  return results;
}

}  // namespace patchlight
