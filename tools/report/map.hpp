// What `ukemi map` tells.
#pragma once

#include "landing/judge/survey.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// Tells it on the terminal, in the summary and in the files; returns the exit code.
int report(const landing::Scene& scene, const landing::Survey& survey, Run& run);

}  // namespace ukemi::tools
