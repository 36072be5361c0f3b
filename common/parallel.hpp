// Work over indices on several threads; results belong to their index, so they do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace ukemi {

/// All cores where `threads` is 0.
inline int thread_count(int threads) {
  return threads > 0 ? threads : std::max(1, int(std::thread::hardware_concurrency()));
}

/// Calls f(i) once for each i in [0, n), on up to `threads` threads, or on as many as can be started.
/// The first exception is rethrown when all have stopped.
template <class F>
void parallel_for(int n, int threads, F&& f) {
  threads = std::min(thread_count(threads), n);
  if (threads <= 1) {
    for (int i = 0; i < n; ++i) f(i);
    return;
  }
  std::atomic<int> next{0};
  std::exception_ptr error;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (int i; (i = next.fetch_add(1)) < n;) f(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
      next = n;
    }
  };
  std::vector<std::thread> pool;
  try {
    pool.reserve(std::size_t(threads - 1));
    for (int t = 1; t < threads; ++t) pool.emplace_back(work);
  } catch (const std::exception&) {  // no memory or no further thread: the others do the work
  }
  work();
  for (std::thread& t : pool) t.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace ukemi
