#include "host/cli/work.hpp"

#include <fmt/format.h>

#include "host/error.hpp"

namespace lamplock::cli {

void take_off_fired(Work& work, const BoardOptions& options) {
  if (options.fired == 0 || options.from >= work.job.targets.size()) return;
  motion::Target& target = work.job.targets[options.from];
  if (options.fired >= target.shots)
    throw Error(Exit::bad_input, fmt::format("--fired {}", options.fired),
                fmt::format("point {} has {} flashes", options.from, target.shots),
                "give fewer, or go on at the next point");
  target.shots = static_cast<std::uint8_t>(target.shots - options.fired);
}

}  // namespace lamplock::cli
