#pragma once

#include <string>

namespace patchlight {

/// A name as a cell of a CSV file (RFC 4180): in quotes where a comma, a quote or a line break would end it early.
/// Before a first letter that makes spreadsheets take a cell for a formula (= + - @, tab, line break) stands an
/// apostrophe, so that it is text.
std::string csv_cell(const std::string& name);

/// A number as a cell, with nine digits; an empty cell stands for one that is not finite.
std::string csv_cell(double number);

}  // namespace patchlight
