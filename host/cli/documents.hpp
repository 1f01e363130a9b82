// Parts of JSON documents that several commands print.
#pragma once

#include "host/cli/json.hpp"
#include "host/geometry/bounds.hpp"
#include "host/points/spacing.hpp"
#include "host/run/job_outcome.hpp"

namespace lamplock::cli {

Json bounds_json(const geometry::Bounds& bounds);
Json spacing_json(const points::SpacingReport& spacing);
/// A report with the end of its job, as `engrave` and `send` print it.
Json job_json(const run::JobOutcome& outcome);

}  // namespace lamplock::cli
