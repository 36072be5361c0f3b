// JSON whose keys stand in the order in which they were given.
#pragma once

#include <nlohmann/json.hpp>

namespace ukemi::tools {

using Json = nlohmann::ordered_json;

}  // namespace ukemi::tools
