#pragma once

#include "patchlight/base/progress.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The result of a case.
struct Measured {
  double value = 0;
  double error_bar = 0;  ///< the value may differ from the exact one by so much
  std::string bar_from;  ///< what the bar is derived from, as in "quadrature"
};

/// A case whose answer is known.
struct ValidationCase {
  std::string name;
  double exact = 0;
  std::string source;  ///< where the exact value comes from: the number in Howell's catalog, or the law
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

/// Form factors, irradiances and radiosities with closed forms or laws, computed by the functions of a solve. The
/// catalog is Howell, A Catalog of Radiation Heat Transfer Configuration Factors.
std::vector<ValidationCase> validation_cases();

/// Runs the cases in order. The same bits for any number of threads. \throws Canceled.
std::vector<ValidationResult> validate(std::span<const ValidationCase> cases, const Observer& observer = {});

}  // namespace patchlight

// Configuration factors of Howell's catalog, with their numbers there. Lengths are in one unit.
namespace patchlight::validation {

/// C-11: from a rectangle of a x b to its equal, directly opposed at distance c.
double opposed_rectangles(double a, double b, double c);

/// C-14: from a rectangle of width w to one of height h at a right angle; l is the length of the edge they share.
double perpendicular_rectangles(double w, double h, double l);

/// C-16: the same at an included angle in radian, above 0 and below pi.
double angled_rectangles(double w, double h, double l, double angle);

/// C-41: from a disc of radius r1 to a parallel coaxial one of radius r2 at distance h.
double coaxial_discs(double r1, double r2, double h);

/// C-91: from the inside of a cylinder of radius r2 to a coaxial one of radius r1 < r2 in it; both have the length h.
double coaxial_cylinders(double r1, double r2, double h);

/// B-3: from an element to a parallel rectangle of a x b at distance c, one corner of which is right above the element.
double element_to_parallel_rectangle(double a, double b, double c);

/// B-4: from an element to a rectangle at a right angle, b wide and a high, that stands on the element's plane at
/// distance c; its foot begins where the element's normal to it meets it.
double element_to_perpendicular_rectangle(double a, double b, double c);

}  // namespace patchlight::validation
