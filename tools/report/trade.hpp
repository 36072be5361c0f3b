// What numbers of a design buy, as a reader sees it.
#pragma once

#include "landing/plan/trade.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

extern const Outputs kTradeOutputs;

/// Among its files: what an interrupted trade and a shard leave for the next run.
inline constexpr const char* kTradeJournal = "trade.part";

struct TradeResult {
  landing::BodyScene scene;
  landing::Trade trade;
  landing::BodyPlanOptions search;
  enum class Of { kDesigns, kFront } of = Of::kDesigns;  ///< as `trade` or as `pareto`
  std::string shard;                                     ///< "2/3"; empty: all designs
  std::string journal;                                   ///< of a part
};

/// Returns the exit code.
int report(const TradeResult& result, Run& run);

}  // namespace ukemi::tools
