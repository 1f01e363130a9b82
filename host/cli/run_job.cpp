#include "host/cli/run_job.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <iostream>
#include <optional>
#include <utility>

#include "host/cli/board_files.hpp"
#include "host/cli/boards.hpp"
#include "host/cli/console.hpp"
#include "host/cli/foresight.hpp"
#include "host/cli/guarding.hpp"
#include "host/cli/job_run.hpp"
#include "host/cli/lamp_watch.hpp"
#include "host/cli/motion_plot_file.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/steering.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/report/files.hpp"
#include "host/units.hpp"
#include "shared/beat_reason.hpp"
#include "sim/chip_board/board_timing.hpp"
#include "sim/virtual_board/virtual_board.hpp"

namespace lamplock::cli {
namespace {

using settings::Id;

double lamp_hz(const settings::Values& values) { return in_units(values, Id::lamp_frequency); }

/// "53 points, 159 flashes"; pauses are neither.
std::string fired_text(const job::Job& job, std::size_t from) {
  if (job.is_rows()) return fmt::format("{} lines", job.size() - from);
  std::size_t points = 0, flashes = 0;
  for (std::size_t i = from; i < job.targets.size(); ++i) {
    points += job.is_pause(i) ? 0u : 1u;
    flashes += job.targets[i].shots;
  }
  const std::string text = fmt::format("{} points", points);
  return flashes == points ? text : fmt::format("{}, {} flashes", text, flashes);
}

/// A real laser fires only when somebody has said so.
void ask_permission(const Work& work, const BoardOptions& options) {
  if (options.yes || work.job.header.dry || options.is_simulated()) return;
  const std::string lamp =
      work.job.is_rows() ? "" : fmt::format(", lamp {:g} Hz", lamp_hz(work.job.settings));
  fmt::print(stderr, "{} on {}{}: the laser will fire. Type yes to fire: ",
             fired_text(work.job, options.from), options.board, lamp);
  std::fflush(stderr);
  std::string answer;
  if (!std::getline(std::cin, answer) || answer != "yes")
    throw Error(Exit::interrupted, "engraving", "not permitted, nothing was fired",
                "answer yes, or give --yes");
}

/// --hold-at: a hold that nobody has to type. What the user holds meanwhile stays held.
class HoldOnce {
 public:
  HoldOnce(link::JobSender& sender, const Steering& steering, Progress& progress,
           const link::Transport& transport, std::size_t at_points)
      : sender_(sender),
        steering_(steering),
        progress_(progress),
        transport_(transport),
        at_points_(at_points),
        next_(at_points == 0 ? Next::nothing : Next::hold) {}

  /// To be called after every step of the sender.
  void look() {
    if (next_ == Next::hold && sender_.points_fired() >= at_points_) {
      next_ = Next::resume;
      until_ = transport_.now() + length;
      sender_.pause();
      progress_.note("holding for a second");
    } else if (next_ == Next::resume && transport_.now() >= until_) {
      next_ = Next::nothing;
      if (!steering_.user_decides()) sender_.resume();
    }
  }
  /// To be called when the job is over: what the machine says comes some points late.
  void job_is_over() {
    if (next_ == Next::hold) progress_.note("not held: the job was over before");
  }

 private:
  enum class Next { hold, resume, nothing };
  static constexpr std::chrono::seconds length{1};
  link::JobSender& sender_;
  const Steering& steering_;
  Progress& progress_;
  const link::Transport& transport_;
  std::size_t at_points_;
  Next next_;
  std::chrono::microseconds until_{0};
};

/// Rows of pixels shine while they brake for a hold, points do not.
AtDoor at_door(const job::Job& job) { return job.is_rows() ? AtDoor::ends : AtDoor::holds; }

link::SenderOptions sender_options(const BoardOptions& options, Clocking clocking) {
  link::SenderOptions sending;
  sending.first_index = options.from;
  sending.first_fired = options.fired;
  sending.job_speed = options.job_speed;
  sending.auto_resume = options.auto_resume;
  sending.run_up_lines = options.run_up_lines;
  sending.take_over = options.discard;
  if (clocking == Clocking::lock_step) sending.session = link::simulated_session;
  return sending;
}

/// The machine has fired, or passed a point of a dry run: there is something to report.
bool has_begun(const link::JobSender& sender, const BoardOptions& options) {
  const wire::Status& status = sender.job_status();
  return status.session == sender.session() &&
         (status.shots != 0 || sender.points_fired() > options.from + options.run_up_lines);
}

/// The journal is closed whatever has ended the job.
void finish_journal(link::KeptJob* kept, Outcome& outcome) {
  if (kept == nullptr) return;
  outcome.is_kept = true;
  try {
    kept->finish(outcome.result);
  } catch (...) {
    if (!outcome.error) outcome.error = std::current_exception();
  }
}

bool keeps_to_lamp(const job::Job& job) {
  const auto mode = static_cast<settings::LampMode>(job.settings.whole(Id::lamp_mode));
  return !job.is_rows() && mode != settings::LampMode::free_beat;
}

/// Runs a job; what goes wrong once it has begun is in the outcome.
Outcome send(link::Transport& transport, const Work& work, const BoardOptions& options,
             Clocking clocking, const Foresight& foresight, link::KeptJob* kept = nullptr) {
  link::SenderOptions sending = sender_options(options, clocking);
  if (kept != nullptr) kept->keep(sending);
  Progress progress(work.job.header.dry ? "dry run" : "engraving", work.job.size(), options.from);
  if (clocking == Clocking::wall)
    sending.on_text = [&progress](const std::string& text) { progress.note("machine: " + text); };
  link::JobSender sender(transport, work.job, sending);
  Steering steering(sender, progress, clocking);
  HoldOnce hold(sender, steering, progress, transport, options.hold_at);
  std::optional<LampWatch> lamp;
  if (clocking == Clocking::lock_step && keeps_to_lamp(work.job)) lamp.emplace(work.job.settings);
  Guarding guarding(options, transport);
  guarding.begin(work.job.header.dry ? gpio::Work::motion : gpio::Work::laser);
  const auto look_after = [&] {
    try {
      // At another speed than foreseen the pace so far has to do.
      const bool as_foreseen = sender.job_speed() == options.job_speed;
      progress.set_left(as_foreseen ? foresight.left_s(sender.points_fired()) : std::nullopt);
      // Before the user is asked what to do: a simulated lamp does not come back.
      if (lamp) lamp->look(sender, transport.now());
      steering.look();
      hold.look();
      guarding.look(steering, at_door(work.job));
    } catch (...) {  // a terminal that has gone must not leave the machine running
      sender.fail(std::current_exception());
    }
  };
  Outcome outcome;
  try {
    // Looked after at every step: simulated time runs fast, and a hold should be seen at once.
    while (sender.step()) look_after();
    guarding.end();
    hold.job_is_over();
  } catch (...) {
    outcome.error = std::current_exception();
  }
  outcome.result = sender.result();
  finish_journal(kept, outcome);
  if (outcome.error && !has_begun(sender, options)) std::rethrow_exception(outcome.error);
  outcome.ended_by = guarding.ended_by();
  return outcome;
}

/// Points of which the machine has fired all flashes; a dry run fires none.
std::uint64_t points_fired(const job::Job& job, std::size_t from, const link::JobResult& result) {
  const std::size_t next = std::clamp<std::size_t>(result.status.first_unfired, from, job.size());
  return job.header.dry ? 0 : job.points_before(next) - job.points_before(from);
}

/// What is known on any board.
report::JobRun run_of(const Work& work, const BoardOptions& options,
                      const link::JobResult& result) {
  const auto before = static_cast<std::ptrdiff_t>(work.job.points_before(options.from));
  report::JobRun run = begin_run(work, {work.points.begin() + before, work.points.end()},
                                 options.board, options.from);
  run.shots_fired = result.status.shots;
  run.points_fired = points_fired(work.job, options.from, result);
  run.beats = result.status.beats;
  run.beats_before = result.status.beats_before;
  run.time_s = static_cast<double>(run.beats) / lamp_hz(run.settings);
  for (std::size_t i = 0; i < beat_reason_count; ++i) {
    const std::string reason(beat_reason_names[i]);
    run.beats_by_reason[reason] = result.status.beats_by_reason[i];
    run.beats_outside[reason] = result.status.beats_outside[i];
  }
  run.checks = {result.status.shots_made, result.status.shots_not_made, result.status.repeats};
  run.link = {result.resent, result.bad_frames + result.status.link.bad_frames, result.reconnects};
  return run;
}

/// What only the simulated world knows.
void add_shots(const sim::Board& board, report::JobRun& run) {
  run.shots_known = true;
  run.shots = board.world().laser().shots();
  const auto& lattice = board.lattice_shots();
  // A pulse taken back by the e-stop has a lattice position and no shot.
  if (lattice.size() == run.shots.size())
    for (const sim::LatticeShot& shot : lattice) run.lattice_steps.push_back(shot.steps);
  if (run.shots.empty()) return;
  const double last_beat_s = 1 / lamp_hz(run.settings);
  run.time_s = sim::seconds(run.shots.back().at - run.shots.front().at) + last_beat_s;
}

/// The timing table on the console, and with the profile in the file that was asked for.
void tell_timing(const sim::BoardTiming& timing, const Work& work, const BoardOptions& options,
                 Console& console) {
  const sim::Picoseconds delay =
      work.job.settings.milli(Id::q_switch_delay) * sim::ps_per_us / 1000;
  const std::string table = sim::timing_text(timing.table(delay));
  console.text(table);
  if (options.timing.empty()) return;
  write_whole(options.timing, [&](const std::filesystem::path& path) {
    write_file(path, table + "\n" + timing.profile_text());
  });
}

/// What was engraved, and how.
std::string plot_title(const Work& work) {
  const settings::Values& values = work.job.settings;
  return fmt::format("{}: {}, {:g} Hz", std::filesystem::path(work.input).filename().string(),
                     mode_name(work.job.header.mode), lamp_hz(values));
}

/// The machine that a job is for. What a laser is, is the machine's own business and not told by
/// jobs.
settings::Values machine_of(const job::Job& job) {
  settings::Values values = job.settings;
  if (job.is_rows()) values.set_milli(Id::laser_mode, settings::row(Id::laser_mode).max_milli);
  return values;
}

Outcome run_simulated(const Work& work, const BoardOptions& options, Console& console) {
  sim::WorldConfig world;
  world.lamp = options.faults.lamp(work.job.settings);
  world.drives = options.drives.drives(work.job.settings);
  const SimulatedBoard made =
      make_board(options.board, options.image, machine_of(work.job), world, options.usb_function());
  sim::Board& board = *made.board;
  std::optional<PinTrace> trace;
  if (!options.vcd.empty()) trace.emplace(options.vcd, board);
  std::optional<MotionPlotFile> plot;
  if (auto* virtual_one = dynamic_cast<sim::VirtualBoard*>(&board);
      virtual_one != nullptr && options.plot.any())
    plot.emplace(options.plot, *virtual_one, work.job.header.dry);
  link::SimulatedTransport transport(board);
  Outcome outcome = send(transport, work, options, Clocking::lock_step, {});
  if (!work.job.is_rows()) {
    outcome.run = run_of(work, options, outcome.result);
    add_shots(board, outcome.run);
  }
  if (trace) trace->finish();
  if (!options.shots.empty())
    write_whole(options.shots, [&outcome](const std::filesystem::path& path) {
      report::write_shots_csv(outcome.run, path);
    });
  if (plot) plot->write(work.job.settings, plot_title(work));
  console.phase("run", fmt::format("{:.1f} s of machine time on the {} board",
                                   sim::seconds(board.now()), board.name()));
  if (made.timing && !work.job.is_rows()) tell_timing(*made.timing, work, options, console);
  return outcome;
}

}  // namespace

Outcome run_job(const Work& work, const BoardOptions& options,
                std::unique_ptr<link::Transport> port, Console& console, link::KeptJob* kept) {
  const std::string item = work.job.item();
  if (options.from >= work.job.size())
    throw Error(Exit::bad_input, fmt::format("--from {}", options.from),
                fmt::format("the job has {} {}s", work.job.size(), item),
                fmt::format("{}s count from 0, the last is {}", item, work.job.size() - 1));
  const std::size_t last = work.job.size() - 1;
  if (options.hold_at != 0 && (options.hold_at <= options.from || options.hold_at > last))
    throw Error(Exit::bad_input, fmt::format("--hold-at {}", options.hold_at),
                fmt::format("the job goes from {} {} to {} {}", item, options.from, item, last),
                last > options.from
                    ? fmt::format("give a number from {} to {}", options.from + 1, last)
                    : "leave it out");
  const Foresight foresight = port && !work.job.header.dry
                                  ? foresee(work.job, *port, options.from, options.job_speed)
                                  : Foresight();
  ask_permission(work, options);
  console.restart_clock();
  if (!port) return run_simulated(work, options, console);
  Outcome outcome = send(*port, work, options, Clocking::wall, foresight, kept);
  if (!work.job.is_rows()) outcome.run = run_of(work, options, outcome.result);
  console.phase("run", "on " + options.board);
  return outcome;
}

}  // namespace lamplock::cli
