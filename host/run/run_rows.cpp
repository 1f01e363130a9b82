#include "host/run/run_rows.hpp"

#include "host/duration_text.hpp"
#include "host/error.hpp"
#include "host/link/kept_job.hpp"
#include "host/link/transport.hpp"
#include "host/run/frontend.hpp"
#include "host/run/run_job.hpp"

#include <array>
#include <chrono>
#include <utility>

namespace lamplock::run {
namespace {

/// What is about points and their shots.
void check_row_options(const BoardOptions& options) {
  const std::array<std::pair<const char*, bool>, 6> of_points{
      {{"--fired", options.fired != 0},
       {"--report", !options.report.empty()},
       {"--statistics", !options.statistics.empty()},
       {"--shots", !options.shots.empty()},
       {"--timing", !options.timing.empty()},
       {"--plot", options.plot.any()}}};
  for (const auto& [name, given] : of_points)
    if (given) throw Error(Exit::bad_input, name, "is for points, not for rows", "leave it out");
}

}  // namespace

std::string rows_text(const job::Job& job) {
  std::uint64_t pixels = 0;
  std::size_t rapids = 0;
  for (const std::uint16_t run : job.rows.runs)
    if (wire::run_power(run) != 0) pixels += wire::run_cells(run);
  for (const job::Line& line : job.rows.lines)
    if (!line.to.light) ++rapids;
  return fmt::format("{} lines, {} pixels in {} rows", job.size(), pixels, rapids);
}

JobOutcome run_rows(PreparedJob& prepared, BoardOptions options, double planned_s,
                    std::unique_ptr<link::Transport> port, Frontend& frontend,
                    link::KeptJob* kept) {
  check_row_options(options);
  frontend.phase("job",
                 fmt::format("{}: {}, about {}{}", prepared.input, rows_text(prepared.job),
                             duration_text(planned_s), prepared.job.header.dry ? ", dry" : ""));
  const std::size_t ordered_from = options.from;
  options.from = job::continue_at(prepared.job.rows, ordered_from);
  options.run_up_lines = ordered_from - options.from;
  JobOutcome outcome = run_job(prepared, options, std::move(port), frontend, kept);
  const link::JobResult& result = outcome.result;
  frontend.say("{:<8}  {} of {} lines in {}", end_name(outcome), result.rest.first,
               prepared.job.size(),
               duration_text(std::chrono::duration<double>(result.elapsed).count()));
  return outcome;
}

}  // namespace lamplock::run
