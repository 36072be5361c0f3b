// What numbers of a design buy, as a reader sees it.
#pragma once

#include "landing/plan/trade.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

extern const Outputs kTradeOutputs;

/// Returns the exit code.
int report(const landing::BodyScene& scene, const landing::Trade& trade, const landing::BodyPlanOptions& search,
           Run& run);

}  // namespace ukemi::tools
