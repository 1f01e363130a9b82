#include "host/cli/foresight.hpp"

#include <algorithm>

#include "host/error.hpp"
#include "host/estimate/estimate.hpp"

namespace lamplock::cli {

Foresight::Foresight(const job::Job& job, std::size_t first, std::uint32_t job_speed)
    : first_(first) {
  if (job.is_rows()) return;
  estimate::EstimateOptions options;
  options.first = first;
  options.job_speed = job_speed;
  const estimate::Estimate foreseen = estimate::estimate_job(job, options);
  if (foreseen.beats == 0) return;
  beat_s_ = foreseen.time_s / static_cast<double>(foreseen.beats);
  beat_.reserve(job.targets.size() - first);
  std::size_t shots = 0;
  for (std::size_t i = first; i < job.targets.size(); ++i) {
    shots = std::min<std::size_t>(shots + job.targets[i].shots, foreseen.beat_of_shot.size());
    beat_.push_back(shots == 0 ? 0 : foreseen.beat_of_shot[shots - 1]);
  }
}

std::optional<double> Foresight::left_s(std::size_t done) const {
  if (beat_.empty() || done < first_) return std::nullopt;
  if (done - first_ >= beat_.size()) return 0.0;
  return static_cast<double>(beat_.back() - beat_[done - first_]) * beat_s_;
}

}  // namespace lamplock::cli
