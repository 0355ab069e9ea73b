#pragma once

#include "patchlight/simulate.h"

#include <string>

namespace patchlight::cli {

/// The error of a mesh as a share: of all parts that are known.
double known_error(const AccuracyStep& step);

/// "4.2 %: mesh 3.1, ...; points within a patch differ from its mean by ...".
std::string errors_in_words(const AccuracyStep& step);

/// What a mesh gave, told as soon as it is solved: "12345 patches, 4.2 % (mesh 3.1, form factors 2.8, solver 0.01), 23
/// s", the seconds since the first one was begun.
std::string step_in_words(const AccuracyStep& step);

}  // namespace patchlight::cli
