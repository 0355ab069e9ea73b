#pragma once

#include "patchlight/base/progress.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// What a case yields.
struct Measured {
  double value = 0;
  double error_bar = 0;  ///< the value may differ from the exact one by so much
  std::string bar_from;  ///< what the bar is derived from, as in "quadrature"
};

/// A case whose answer is known.
struct ValidationCase {
  std::string name;
  double exact = 0;
  std::string source;  ///< where the exact value comes from: the number in Howell's catalogue, or the law
  std::function<Measured(const Observer&)> measure;
};

/// The outcome of a case.
struct ValidationResult {
  std::string name;
  double exact = 0;
  std::string source;
  Measured measured;
};

/// The verdict: the value lies within its bar around the exact one. False for a value that is not a number.
bool within_bar(const ValidationResult& result);

/// Form factors, irradiances and radiosities with closed forms or laws; computed by the functions that a solve uses.
/// The catalogue is Howell, A Catalog of Radiation Heat Transfer Configuration Factors.
std::vector<ValidationCase> validation_cases();

/// Runs the cases in order. The same bits for any number of threads. \throws Cancelled.
std::vector<ValidationResult> validate(std::span<const ValidationCase> cases, const Observer& observer = {});

}  // namespace patchlight
