#include "host/serve/computations.hpp"

#include <utility>

#include "host/error.hpp"
#include "host/serve/refusal.hpp"

namespace lamplock::serve {

void Computations::add(Work work, Done done) {
  if (all_.size() >= max_waiting) throw Refusal(Exit::job_failed, "many-files");
  all_.push_back({std::move(work), std::move(done)});
  if (all_.size() == 1) begin_next();
}

void Computations::begin_next() {
  if (all_.empty() || running_.is_busy()) return;
  running_.start([work = all_.front().work] {
    work();
    return true;
  });
}

void Computations::poll() {
  std::exception_ptr error;
  try {
    if (!running_.take()) return begin_next();
  } catch (...) {
    error = std::current_exception();
  }
  if (!all_.empty()) {
    const One ended = std::move(all_.front());
    all_.pop_front();
    ended.done(error);
  }
  begin_next();
}

void Computations::end() { all_.clear(); }

}  // namespace lamplock::serve
