// Progress of a long computation to its caller, and how the caller ends it early.
#pragma once

#include <functional>

namespace ukemi {

/// Receives progress, and says whether to end. Either may be empty; both may be called from several threads at once.
struct Monitor {
  std::function<void(long done, long total)> tell;  ///< items of work done, of how many
  std::function<bool()> stop;                       ///< true: end soon and keep what is finished; called often

  void progress(long done, long total) const {
    if (tell) tell(done, total);
  }
  bool stopped() const { return stop && stop(); }
};

}  // namespace ukemi
