// A landing for Python, as the search's answer has it too.
#pragma once

#include "landing/judge/checked.hpp"
#include "tools/python/bind.hpp"

namespace ukemi::python {

/// A landing with its trajectory; the sensitivity where it was looked at.
struct Played {
  landing::Landing landing;
  std::optional<landing::Sensitivity> sensitivity;
};
/// |ddr_0| over time of landings by their names.
Figure figure(const std::vector<std::pair<std::string, const landing::Landing*>>& landings);
/// Forbidden points by their names.
std::array<bool, landing::kPoints> points_of(const std::vector<std::string>& names);

}  // namespace ukemi::python
