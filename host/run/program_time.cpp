#include "host/run/program_time.hpp"

#include <algorithm>

namespace lamplock::run {

std::optional<double> ProgramTime::left_s(double run_s, int feed_percent, int rapid_percent) {
  const program_run::SpeedChange now{run_s, static_cast<std::uint32_t>(feed_percent),
                                     static_cast<std::uint32_t>(rapid_percent)};
  const auto feed_of = [this](std::size_t changes) {
    return changes == 0 ? program_run::SpeedChange() : changes_[changes - 1];
  };
  const program_run::SpeedChange last = feed_of(changes_.size());
  if (last.feed_percent != now.feed_percent || last.rapid_percent != now.rapid_percent)
    changes_.push_back(now);
  if (const auto made = next_.take()) {
    planned_s_ = *made;
    planned_changes_ = begun_changes_;
  }
  if (!planned_s_) return std::nullopt;
  const double left = std::max(0.0, *planned_s_ - run_s);
  if (planned_changes_ == changes_.size()) return left;
  if (!next_.is_busy()) {
    begun_changes_ = changes_.size();
    next_.start([plan = plan_, changes = changes_] { return plan(changes); });
  }
  return left * feed_of(planned_changes_).feed_percent / now.feed_percent;
}

}  // namespace lamplock::run
