// Supply of landings to the lanes of batch.hpp and body_batch.hpp.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <span>

namespace ukemi::landing {

/// Supplies landings as lanes become free. Lanes do not influence each other's results: a source that gives each lane
/// its own work gets the same results for any number of lanes.
template <class Case, class Result>
class LaneSource {
 public:
  virtual ~LaneSource() = default;
  /// Sets the lane's next landing; false if there is none (it is then not called again).
  virtual bool next(int lane, Case& c) = 0;
  /// Receives the result of the lane's landing.
  virtual void done(int lane, const Result& result) = 0;
  /// Polled every few dozen steps: true ends the run without results of the landings under way.
  virtual bool over() { return false; }
};

/// Largest number of lanes of any instruction set.
inline constexpr int kMaxLanes = 8;

/// Supplies cases in order to any free lane of any thread.
template <class Case, class Result>
class CaseQueue : public LaneSource<Case, Result> {
 public:
  /// `next`: index of the next case, shared by all threads.
  CaseQueue(std::span<const Case> cases, std::span<Result> results, std::atomic<std::size_t>& next,
            const std::function<bool()>* over)
      : cases_(cases), results_(results), next_(next), over_(over) {}
  bool next(int lane, Case& c) override {
    const std::size_t i = case_of_lane_[std::size_t(lane)] = next_++;
    if (i >= cases_.size() || over()) return false;
    c = cases_[i];
    return true;
  }
  void done(int lane, const Result& result) override { results_[case_of_lane_[std::size_t(lane)]] = result; }
  bool over() override { return over_ && (*over_)(); }

 private:
  std::span<const Case> cases_;
  std::span<Result> results_;
  std::atomic<std::size_t>& next_;
  const std::function<bool()>* over_;
  std::array<std::size_t, kMaxLanes> case_of_lane_{};
};

}  // namespace ukemi::landing
