#pragma once

#include <string>
#include <vector>

namespace patchlight::cli {

using TextRow = std::vector<std::string>;

/// Rows as lines with columns, each as wide as its widest cell; all rows have as many cells as the first.
std::string text_table(const std::vector<TextRow>& rows);

}  // namespace patchlight::cli
