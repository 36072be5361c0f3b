// Report of a design trade-off: the best landing for each value of design numbers.
#pragma once

#include "landing/plan/trade.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

extern const Outputs kTradeOutputs;

/// Journal that an interrupted trade and a shard leave for the next run.
inline constexpr const char* kTradeJournal = "trade.part";

struct TradeResult {
  landing::BodyScene scene;
  landing::Trade trade;
  landing::BodyPlanOptions search;
  enum class Of { kDesigns, kFront } of = Of::kDesigns;  ///< of `trade`; of `pareto`
  std::string shard;                                     ///< "2/3"; empty: all designs
  std::string journal;                                   ///< of an incomplete run; else empty
};

/// Returns the exit code.
int report(const TradeResult& result, Run& run);

}  // namespace ukemi::tools
