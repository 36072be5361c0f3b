// Journal of a trade: each planned design is on the disk before the next one begins.
#pragma once

#include <span>
#include <string>

#include "common/journal.hpp"
#include "landing/plan/trade.hpp"

namespace ukemi::landing {

class TradeJournal {
 public:
  /// Restores the records of an earlier run into `points`, one for each design. Throws InputError as Journal: another
  /// identity (16 characters), or in use. `joints`: of the robot.
  TradeJournal(const std::string& path, const std::string& identity, std::size_t joints, std::span<TradePoint> points);
  /// Throws InputError with the system's reason.
  void add(std::size_t design, const TradePoint& point);
  std::string bytes() const { return journal_.bytes(); }

 private:
  std::size_t joints_;
  Journal journal_;
};

}  // namespace ukemi::landing
