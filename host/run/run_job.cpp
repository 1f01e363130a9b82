#include "host/run/run_job.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <functional>
#include <optional>
#include <stdexcept>
#include <utility>

#include "host/duration_text.hpp"
#include "host/error.hpp"
#include "host/link/board_text.hpp"
#include "host/link/dialog.hpp"
#include "host/link/kept_job.hpp"
#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/link/transport.hpp"
#include "host/report/files.hpp"
#include "host/run/before_firing.hpp"
#include "host/run/board_files.hpp"
#include "host/run/board_link.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_run.hpp"
#include "host/run/lock_timeout.hpp"
#include "host/run/mode_name.hpp"
#include "host/run/motion_plot_file.hpp"
#include "host/run/outside_work_space.hpp"
#include "host/run/permission.hpp"
#include "host/run/point_job_control.hpp"
#include "host/run/remaining_time.hpp"
#include "host/run/report_folder.hpp"
#include "host/run/report_job.hpp"
#include "host/run/setting_refusal.hpp"
#include "host/run/simulated_boards.hpp"
#include "host/run/supervisor.hpp"
#include "host/units.hpp"
#include "sim/chip_board/board_timing.hpp"
#include "sim/virtual_board/virtual_board.hpp"

namespace lamplock::run {
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

/// A real laser fires only with a permission.
void ask_permission(const PreparedJob& prepared, const BoardOptions& options, Frontend& frontend) {
  if (prepared.job.header.dry) return;
  const std::string lamp =
      prepared.job.is_rows() ? "" : fmt::format(", lamp {:g} Hz", lamp_hz(prepared.job.settings));
  const std::string question = fmt::format(
      "{} on {}{}: the laser will fire. Type yes to fire: ", fired_text(prepared.job, options.from),
      options.board, lamp);
  require_permission(options, frontend, question, "engraving", "nothing was fired");
}

/// --hold-at: a hold of a second. A hold of the user in that time stays.
class HoldOnce {
 public:
  HoldOnce(link::JobSender& sender, const JobControl& control, Progress& progress,
           const link::Transport& transport, std::size_t at_points)
      : sender_(sender),
        control_(control),
        progress_(progress),
        transport_(transport),
        at_points_(at_points),
        next_(at_points == 0 ? Next::nothing : Next::hold) {}

  /// To be called after every step of the sender.
  void poll() {
    if (next_ == Next::hold && sender_.points_fired() >= at_points_) {
      next_ = Next::resume;
      until_ = transport_.now() + length;
      sender_.pause();
      progress_.note("holding for a second");
    } else if (next_ == Next::resume && transport_.now() >= until_) {
      next_ = Next::nothing;
      if (!control_.waits_for_user()) sender_.resume();
    }
  }
  /// To be called when the job is over: the machine reports some points late.
  void job_is_over() {
    if (next_ == Next::hold) progress_.note("not held: the job was over before");
  }

 private:
  enum class Next { hold, resume, nothing };
  static constexpr std::chrono::seconds length{1};
  link::JobSender& sender_;
  const JobControl& control_;
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

/// The machine has fired, or passed a point of a dry run, or may have done so after its last
/// report: there is something to report.
bool has_begun(const link::JobSender& sender, const BoardOptions& options) {
  const wire::Status& status = sender.job_status();
  if (status.session != sender.session()) return false;
  return status.shots != 0 || sender.points_fired() > options.from + options.run_up_lines ||
         !sender.result().rest.settled;
}

/// The journal is closed whatever has ended the job.
void finish_journal(link::KeptJob* kept, JobOutcome& outcome) {
  if (kept == nullptr) return;
  outcome.is_kept = true;
  try {
    kept->finish(outcome.result);
  } catch (...) {
    if (!outcome.error) outcome.error = std::current_exception();
  }
}

/// The machine has not begun the job.
[[noreturn]] void throw_refusal(const std::exception_ptr& error, link::Transport& transport,
                                const job::Job& job, const BoardOptions& options) {
  before_firing([&] {
    try {
      std::rethrow_exception(error);
    } catch (const link::RefusedSetting& refusal) {
      explain_refusal(refusal, job, transport, options);
    } catch (const Error& refusal) {
      const bool is_of_points = refusal.exit() == Exit::bad_input && !options.is_simulated();
      if (is_of_points) require_inside_work_space(transport, options);
      throw;
    }
  });
  throw std::logic_error("a refusal is an error");  // not reached
}

/// Runs a job; what goes wrong once it has begun is in the outcome.
JobOutcome send(link::Transport& transport, const PreparedJob& prepared,
                const BoardOptions& options, Clocking clocking, RemainingTime& remaining,
                Frontend& frontend, link::KeptJob* kept = nullptr) {
  link::SenderOptions sending = sender_options(options, clocking);
  if (kept != nullptr) kept->keep(sending);
  const job::Job& job = prepared.job;
  const std::unique_ptr<Progress> shown =
      frontend.progress(job.header.dry ? "dry run" : "engraving",
                        job.is_rows() ? job.size() : job.points_before(job.size()),
                        job.is_rows() ? options.from : job.points_before(options.from));
  Progress& progress = *shown;
  if (clocking == Clocking::wall)
    sending.on_text = [&progress](const std::string& text) {
      progress.note("machine: " + link::message_text(text));
    };
  link::JobSender sender(transport, prepared.job, sending);
  PointJobControl control(sender, frontend, progress, clocking, pauses_of(job));
  HoldOnce hold(sender, control, progress, transport, options.hold_at);
  std::optional<LockTimeout> lamp;
  if (clocking == Clocking::lock_step && prepared.job.keeps_to_lamp())
    lamp.emplace(prepared.job.settings);
  Supervisor supervisor(options, transport);
  before_firing([&] {
    supervisor.begin(prepared.job.header.dry ? gpio::LaserUse::motion : gpio::LaserUse::laser);
  });
  const auto supervise = [&] {
    try {
      progress.set_left(remaining.left_s(sender.points_fired(), sender.job_speed()));
      // Before the user is asked what to do: a simulated lamp does not come back.
      if (lamp) lamp->poll(sender, transport.now());
      control.poll();
      hold.poll();
      supervisor.poll(control, at_door(prepared.job));
    } catch (...) {  // a terminal that has gone must not leave the machine running
      sender.fail(std::current_exception());
    }
  };
  JobOutcome outcome;
  try {
    // At every step: simulated time runs fast, and a hold should be seen at once.
    while (sender.step()) supervise();
    supervisor.end();
    hold.job_is_over();
  } catch (...) {
    outcome.error = std::current_exception();
  }
  outcome.result = sender.result();
  finish_journal(kept, outcome);
  if (outcome.error && !has_begun(sender, options))
    throw_refusal(outcome.error, transport, prepared.job, options);
  outcome.ended_by = supervisor.ended_by();
  if (clocking == Clocking::wall && outcome.result.end == link::JobEnd::alarm) {
    link::LinePort port(transport);
    outcome.homing = link::ask_homing(port);
  }
  return outcome;
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

/// The timing table on the frontend, and with the profile in the file that was asked for.
void report_timing(const sim::BoardTiming& timing, const PreparedJob& prepared,
                   const BoardOptions& options, JobOutcome& outcome, Frontend& frontend) {
  const sim::Picoseconds delay =
      prepared.job.settings.milli(Id::q_switch_delay) * sim::ps_per_us / 1000;
  const std::string table = sim::timing_text(timing.table(delay));
  frontend.text(table);
  if (options.timing.empty()) return;
  outcome.lost.attempt(options.timing,
                       [&] { write_whole(options.timing, table + "\n" + timing.profile_text()); });
}

/// What was engraved, and how.
std::string plot_title(const PreparedJob& prepared) {
  const settings::Values& values = prepared.job.settings;
  return fmt::format("{}: {}, {:g} Hz", std::filesystem::path(prepared.input).filename().string(),
                     mode_name(prepared.job.header.mode), lamp_hz(values));
}

/// The simulated machine: the one that was given, as a port has one, otherwise the one that the job
/// is for. A job does not contain the kind of the laser, so it follows from the job.
settings::Values machine_of(const PreparedJob& prepared) {
  if (prepared.machine) return *prepared.machine;
  const job::Job& job = prepared.job;
  settings::Values values = job.settings;
  if (job.is_rows()) values.set_milli(Id::laser_mode, settings::row(Id::laser_mode).max_milli);
  return values;
}

/// Writes the files that are about the simulated board; what cannot be written is lost.
void write_board_files(JobOutcome& outcome, const BoardOptions& options, PinTrace* trace,
                       const std::function<void()>& write_plot) {
  LostFiles& lost = outcome.lost;
  if (trace != nullptr) lost.attempt(options.vcd, [trace] { trace->finish(); });
  if (!options.shots.empty())
    lost.attempt(options.shots, [&] {
      write_whole(options.shots, [&outcome](const std::filesystem::path& path) {
        report::write_shots_csv(outcome.run, path);
      });
    });
  if (write_plot) lost.attempt(options.plot.file, write_plot);
}

JobOutcome run_simulated(const PreparedJob& prepared, const BoardOptions& options,
                         std::unique_ptr<ReportFolder> folder, Frontend& frontend) {
  const settings::Values machine = machine_of(prepared);
  sim::WorldConfig world;
  world.lamp = options.faults.lamp(machine);
  world.drives = options.drives.drives(machine);
  world.heat = options.spot.heat(machine);
  const SimulatedBoard made =
      make_board(options.board, options.image, machine, world, options.usb_function());
  sim::Board& board = *made.board;
  std::optional<PinTrace> trace;
  if (!options.vcd.empty()) trace.emplace(options.vcd, board);
  std::optional<MotionPlotFile> plot;
  if (auto* virtual_one = dynamic_cast<sim::VirtualBoard*>(&board);
      virtual_one != nullptr && options.plot.any())
    plot.emplace(options.plot, *virtual_one, prepared.job.header.dry);
  link::SimulatedTransport transport(board);
  if (machine.whole(Id::homing) != 0) {
    link::LinePort port(transport);
    link::unlock(port);  // locked at power-up; no other command can precede this one
  }
  RemainingTime unknown;  // the wall clock does not pass as the machine's does
  JobOutcome outcome = send(transport, prepared, options, Clocking::lock_step, unknown, frontend);
  if (!prepared.job.is_rows()) {
    outcome.run = run_on_board(prepared, options, outcome);
    outcome.folder = std::move(folder);
    add_shots(board, outcome.run);
    write_numbers(outcome, options);
  }
  const auto write_plot = [&] { plot->write(prepared.job.settings, plot_title(prepared)); };
  write_board_files(outcome, options, trace ? &*trace : nullptr,
                    plot ? std::function<void()>(write_plot) : nullptr);
  frontend.phase("run", fmt::format("{} of machine time on the {} board",
                                    duration_text(sim::seconds(board.now())), board.name()));
  if (made.timing && !prepared.job.is_rows())
    report_timing(*made.timing, prepared, options, outcome, frontend);
  return outcome;
}

/// Plans the time of the job as the machine will; a job that the plan refuses would be refused by
/// the machine.
void plan_rest(std::optional<RemainingTime>& remaining, const PreparedJob& prepared,
               link::Transport& port, const BoardOptions& options) {
  if (prepared.job.header.dry) return void(remaining.emplace());
  try {
    remaining.emplace(job_on_machine(prepared.job, port), options.from, options.job_speed);
  } catch (...) {
    throw_refusal(std::current_exception(), port, prepared.job, options);
  }
}

}  // namespace

JobOutcome run_job(const PreparedJob& prepared, const BoardOptions& options,
                   std::unique_ptr<link::Transport> port, Frontend& frontend, link::KeptJob* kept) {
  const std::string item = prepared.job.item();
  if (options.from >= prepared.job.size())
    throw Error(Exit::bad_input, fmt::format("--from {}", options.from),
                fmt::format("the job has {} {}s", prepared.job.size(), item),
                fmt::format("{}s count from 0, the last is {}", item, prepared.job.size() - 1));
  const std::size_t last = prepared.job.size() - 1;
  if (options.hold_at != 0 && (options.hold_at <= options.from || options.hold_at > last))
    throw Error(Exit::bad_input, fmt::format("--hold-at {}", options.hold_at),
                fmt::format("the job goes from {} {} to {} {}", item, options.from, item, last),
                last > options.from
                    ? fmt::format("give a number from {} to {}", options.from + 1, last)
                    : "leave it out");
  std::optional<RemainingTime> remaining;
  if (port)
    plan_rest(remaining, prepared, *port, options);
  else
    remaining.emplace();
  ask_permission(prepared, options, frontend);
  auto folder = options.report.empty() ? nullptr : std::make_unique<ReportFolder>(options.report);
  frontend.restart_clock();
  if (!port) return run_simulated(prepared, options, std::move(folder), frontend);
  JobOutcome outcome = send(*port, prepared, options, Clocking::wall, *remaining, frontend, kept);
  if (!prepared.job.is_rows()) {
    outcome.run = run_on_board(prepared, options, outcome);
    outcome.folder = std::move(folder);
    write_numbers(outcome, options);
  }
  frontend.phase("run", "on " + options.board);
  return outcome;
}

}  // namespace lamplock::run
