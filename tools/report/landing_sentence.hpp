// A landing in one sentence.
#pragma once

#include <string>

namespace ukemi::tools {

/// "Lands with 195 m/s^2 where holding still takes 466: 58 % softer."; `held` is NaN if unknown.
std::string landing_sentence(double peak, double held);

}  // namespace ukemi::tools
