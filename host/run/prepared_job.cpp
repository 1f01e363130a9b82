#include "host/run/prepared_job.hpp"

#include <fmt/format.h>

#include "host/error.hpp"

namespace lamplock::run {

void subtract_fired(PreparedJob& prepared, const BoardOptions& options) {
  if (options.fired == 0 || options.from >= prepared.job.targets.size()) return;
  wire::Target& target = prepared.job.targets[options.from];
  if (options.fired >= target.shots)
    throw Error(Exit::bad_input, fmt::format("--fired {}", options.fired),
                fmt::format("point {} has {} flashes", options.from, target.shots),
                "give fewer, or continue at the next point");
  target.shots = static_cast<std::uint8_t>(target.shots - options.fired);
}

}  // namespace lamplock::run
