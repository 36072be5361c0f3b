// ukemi atlas --ask.
#pragma once

#include <functional>
#include <string>

#include "landing/search/goal.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// What the atlas of a folder has for the drop that `drop` makes of its scene's, by the scene that lies beside it.
/// Throws InputError as the readers, and for a drop that cannot be.
int ask_atlas(const std::string& folder, landing::Goal goal,
              const std::function<landing::Drop(const landing::Drop& own)>& drop, Run& run);

}  // namespace ukemi::tools
