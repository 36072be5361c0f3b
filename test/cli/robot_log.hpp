// The trajectory of a robot of links as a log of it.
#pragma once

#include <fmt/format.h>

#include <sstream>
#include <string>
#include <vector>

#include "common/random.hpp"

/// The joints' angles, with noise [rad], and their references, in the rows that are not beside an event.
inline std::string as_log(const std::string& trajectory, double noise) {
  constexpr double kNear = 1e-3;  // [s]
  ukemi::Random random(20261127, 3);
  std::string out, line;
  std::vector<std::string> names;
  double last = -1;
  for (std::istringstream in(trajectory); std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    const bool header = names.empty();
    if (header) names = cells;
    if (!header && std::stod(cells[0]) < last + kNear) continue;
    if (!header) last = std::stod(cells[0]);
    out += cells[0];
    for (std::size_t c = 1; c < cells.size(); ++c) {
      if (!names[c].starts_with("phi_") || names[c].starts_with("phi_m_")) continue;
      const bool exact = header || names[c].starts_with("phi_ref_");
      out += exact ? "," + cells[c] : fmt::format(",{:.9g}", std::stod(cells[c]) + noise * random.normal());
    }
    out += "\n";
  }
  return out;
}
