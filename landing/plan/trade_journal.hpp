// Designs of a trade as they are planned, on the disk before the next one is begun.
#pragma once

#include <span>
#include <string>

#include "common/journal.hpp"
#include "landing/plan/trade.hpp"

namespace ukemi::landing {

class TradeJournal {
 public:
  /// Takes what an earlier run left there into `points`, of which there are as many as designs. Throws InputError as
  /// Journal: of a trade with another identity (16 characters), or in use. `joints`: of the robot.
  TradeJournal(const std::string& path, const std::string& identity, std::size_t joints, std::span<TradePoint> points);
  /// Throws InputError with the system's reason.
  void add(std::size_t design, const TradePoint& point);
  std::string bytes() const { return journal_.bytes(); }

 private:
  std::size_t joints_;
  Journal journal_;
};

}  // namespace ukemi::landing
