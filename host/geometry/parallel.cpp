#include "host/geometry/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace lamplock::geometry {

void for_each_index(std::size_t count, unsigned threads,
                    const std::function<void(std::size_t)>& work) {
  // Large enough that the counter is no bottleneck, small enough that no thread waits long.
  constexpr std::size_t batch = 8;
  std::atomic<std::size_t> next{0};
  std::mutex failed;
  std::exception_ptr failure;
  std::size_t failed_at = count;
  const auto run = [&] {
    std::size_t i = 0;
    try {
      for (;;) {
        const std::size_t first = next.fetch_add(batch);
        if (first >= count) return;
        for (i = first; i < std::min(count, first + batch); ++i) work(i);
      }
    } catch (...) {
      const std::lock_guard lock(failed);
      if (i < failed_at) {
        failed_at = i;
        failure = std::current_exception();
      }
      next = count;
    }
  };
  constexpr std::size_t max_threads = 256;
  // The system reads this number from a file at each call.
  static const unsigned cores = std::thread::hardware_concurrency();
  const std::size_t wanted = threads > 0 ? threads : cores;
  const std::size_t useful = std::min(max_threads, count / batch + 1);
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < std::min(wanted, useful); ++i) others.emplace_back(run);
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace lamplock::geometry
