// Fewer rows of a long table, without the loss of a peak.
#pragma once

#include <cstddef>
#include <vector>

namespace ukemi::tools {

/// The indices of rows that stay where at most some (1 + 2 columns) `most` of them may: the first of each part, and the
/// smallest and largest of every column.
std::vector<std::size_t> kept_rows(const std::vector<const std::vector<double>*>& columns, std::size_t most);

}  // namespace ukemi::tools
