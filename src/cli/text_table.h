#pragma once

#include <string>
#include <vector>

namespace patchlight::cli {

using TextRow = std::vector<std::string>;

/// A number with so many digits; "-" for what is not finite.
std::string rounded(double value, int digits = 3);

/// A share in percent, without the sign, with so many digits.
std::string percent(double share, int digits = 3);

/// Rows as lines with columns, each as wide as its widest cell; all rows have as many cells as the first.
std::string text_table(const std::vector<TextRow>& rows);

}  // namespace patchlight::cli
