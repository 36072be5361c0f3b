// The parameters of the paper's robot as those of a robot of links (by_links.hpp).
#pragma once

#include "landing/derivatives/body_gradient.hpp"
#include "landing/derivatives/gradient.hpp"

namespace ukemi::landing {

/// Those of the floor are of all contacts together.
BodyParameter body_parameter(Parameter parameter);

}  // namespace ukemi::landing
