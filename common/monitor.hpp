// Progress of a long computation to its caller, and how the caller ends it early.
#pragma once

#include <functional>

namespace ukemi {

/// Receives progress, and says whether to end. Either may be empty; both may be called from several threads at once.
struct Monitor {
  std::function<void(long done, long total)> on_progress;  ///< items of work done, of how many
  std::function<bool()> stop;                              ///< true: end soon and keep what is finished; called often

  void progress(long done, long total) const {
    if (on_progress) on_progress(done, total);
  }
  bool stopped() const { return stop && stop(); }
};

}  // namespace ukemi
