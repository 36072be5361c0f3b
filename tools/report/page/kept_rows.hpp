// Downsamples a long table without losing peaks.
#pragma once

#include <cstddef>
#include <vector>

namespace ukemi::tools {

/// Indices of the rows to keep, at most about (1 + 2 columns) `parts`: of each of `parts` equal parts the first, and
/// the minimum and maximum of every column. All rows where there are few.
std::vector<std::size_t> kept_rows(const std::vector<const std::vector<double>*>& columns, std::size_t parts);

}  // namespace ukemi::tools
