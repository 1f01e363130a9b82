#include "host/run/job_outcome.hpp"

namespace lamplock::run {

std::string end_name(const JobOutcome& outcome) {
  using link::JobEnd;
  if (outcome.error) return "failed";
  switch (outcome.result.end) {
    case JobEnd::done:
      return "done";
    case JobEnd::stopped:
      return "stopped";
    case JobEnd::alarm:
      return "alarm";
    case JobEnd::lost:
      return "lost";
    case JobEnd::restarted:
      return "restarted";
    case JobEnd::replaced:
      return "replaced";
  }
  return "unknown";
}

}  // namespace lamplock::run
