// ukemi atlas --ask.
#pragma once

#include <functional>
#include <string>

#include "landing/search/goal.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// Reports the atlas's motion for a drop; `drop` maps the drop of the scene in the same folder to the requested one.
/// Returns the exit code. Throws InputError as the readers do, and for an invalid drop.
int ask_atlas(const std::string& folder, landing::Goal goal,
              const std::function<landing::Drop(const landing::Drop& scene)>& drop, Run& run);

}  // namespace ukemi::tools
