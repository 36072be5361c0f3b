#include "common/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "common/text.hpp"

namespace ukemi {

InputError::InputError(const std::string& message) : std::runtime_error(shown(message)) {}

std::string Location::text() const {
  std::string s = file;
  if (line > 0) s += ":" + std::to_string(line);
  if (line > 0 && column > 0) s += ":" + std::to_string(column);
  return s;
}

namespace {
/// Number of letters to substitute, delete, insert, or swap with the next (optimal string alignment distance).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1), previous, second_previous;
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    second_previous = std::move(previous), previous = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({previous[j - 1] + (a[i - 1] != b[j - 1]), previous[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], second_previous[j - 2] + 1);
    }
  }
  return row[b.size()];
}

/// The letters of a name in order, without _: the same for names that differ by a swap or by _ alone.
std::string letters(const std::string& name) {
  std::string out = name;
  std::erase(out, '_');
  std::sort(out.begin(), out.end());
  return out;
}
}  // namespace

std::string nearest(const std::string& given, const std::vector<std::string>& known) {
  std::string best;
  std::size_t distance = std::max<std::size_t>(2, given.size() / 3) + 1;
  for (const std::string& k : known) {
    const bool contained =
        given.size() > 2 && (k.find(given) != std::string::npos || given.find(k) != std::string::npos);
    const std::size_t edits = edit_distance(given, k), d = letters(k) == letters(given) ? 0
                                                           : contained ? std::min<std::size_t>(2, edits)
                                                                       : edits;
    if (d < distance) best = k, distance = d;
  }
  return best;
}

std::string hint(const std::string& given, const std::vector<std::string>& known) {
  const std::string best = nearest(given, known);
  return best.empty() ? "" : " (did you mean \"" + best + "\"?)";
}

std::string one_of(const std::string& given, const std::vector<std::string>& known) {
  return fmt::format("{}: one of {} is needed{}", quoted(given), fmt::join(known, ", "), hint(given, known));
}

std::string quoted(const std::string& value) {
  std::size_t end = 0;
  while (end < std::min<std::size_t>(40, value.size())) end += first_character(value.substr(end, 4)).bytes.size();
  return "'" + shown(value.substr(0, end)) + (end < value.size() ? "...'" : "'");
}

}  // namespace ukemi
