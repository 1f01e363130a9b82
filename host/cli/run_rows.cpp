#include "host/cli/run_rows.hpp"

#include "host/cli/console.hpp"
#include "host/cli/report_job.hpp"
#include "host/cli/run_job.hpp"

#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/raster/row_motion.hpp"

namespace lamplock::cli {
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

Json document(const Work& work, const BoardOptions& options, const Outcome& outcome,
              double planned_s) {
  const link::JobResult& result = outcome.result;
  return {{"job", work.input},
          {"board", options.board},
          {"mode", mode_name(work.job.header.mode)},
          {"end", end_name(outcome)},
          {"lines", work.job.size()},
          {"first_unfired", result.status.first_unfired},
          {"may_have_fired", result.rest.from},
          {"seconds", std::chrono::duration<double>(result.elapsed).count()},
          {"planned_seconds", planned_s},
          {"starvations", result.status.starvations},
          {"resent", result.resent},
          {"bad_frames", result.bad_frames + result.status.link.bad_frames},
          {"reconnects", result.reconnects}};
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

Exit send_rows(Work& work, BoardOptions options, std::unique_ptr<link::Transport> port,
               Console& console, link::KeptJob* kept) {
  check_row_options(options);
  const double planned_s = raster::seconds_of(work.job);
  console.phase("job", fmt::format("{}: {}, about {:.1f} s{}", work.input, rows_text(work.job),
                                   planned_s, work.job.header.dry ? ", dry" : ""));
  const std::size_t ordered_from = options.from;
  options.from = job::go_on_at(work.job.rows, ordered_from);
  options.run_up_lines = ordered_from - options.from;
  const Outcome outcome = run_job(work, options, std::move(port), console, kept);
  const link::JobResult& result = outcome.result;
  console.say("{:<8}  {} of {} lines in {:.1f} s", end_name(outcome), result.status.first_unfired,
              work.job.size(), std::chrono::duration<double>(result.elapsed).count());
  console.document(document(work, options, outcome, planned_s));
  return tell_end(outcome, options, work.job.item());
}

}  // namespace lamplock::cli
