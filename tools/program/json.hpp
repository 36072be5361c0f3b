// JSON whose keys keep the order in which they were inserted.
#pragma once

#include <nlohmann/json.hpp>

namespace ukemi::tools {

using Json = nlohmann::ordered_json;

}  // namespace ukemi::tools
