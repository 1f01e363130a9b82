// Jobs that end at random moments and are continued as the program advises: no point is fired more
// often than ordered, and only points that are listed as doubtful are left out.

#include <fmt/format.h>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "host/error.hpp"
#include "host/link/kept_job.hpp"
#include "tests/board/rig.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::test::resume_test {
namespace {

using link::Continuation;

/// A board and its cable: the cable may be pulled, and the board may restart without any state.
class Bench final : public link::Transport {
 public:
  explicit Bench(const job::Profile& profile)
      : rig(std::make_unique<Rig>(profile)), profile_(profile) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (killed) return bytes.size();  // a killed program sends nothing
    return connected_ ? rig->board.write(bytes) : 0;
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    return connected_ ? rig->board.read(bytes) : 0;
  }
  void wait(std::chrono::microseconds time) override {
    const Picoseconds until = clock() + time.count() * ps_per_us;
    while (!killed && clock() < until && !(connected_ && rig->board.has_output()))
      run_to(std::min(until, clock() + ps_per_ms));
  }
  std::chrono::microseconds now() const override {
    return std::chrono::microseconds(clock() / ps_per_us);
  }
  bool connected() const override { return connected_; }
  bool reconnect() override {
    if (connected_) rig->board.reconnect();
    connected_ = !unplugged;
    return connected_;
  }

  Picoseconds clock() const { return before_ + rig->board.now(); }
  void run(Picoseconds time) { run_to(clock() + time); }
  /// Calls `event` once, at this time of clock().
  void at(Picoseconds time, std::function<void()> event) {
    event_at_ = time;
    event_ = std::move(event);
  }
  void forget_event() { event_ = nullptr; }
  void pull_cable() {
    unplugged = true;
    connected_ = false;
  }
  /// The board loses its power or is reset by its watchdog; `gone` is called just before.
  void restart(Picoseconds outage, const std::function<void()>& gone) {
    gone();
    before_ += rig->board.now() + outage;
    rig = std::make_unique<Rig>(profile_);
    connected_ = false;
  }
  void type(std::string_view text) {
    rig->board.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  std::unique_ptr<Rig> rig;
  bool unplugged = false;
  bool killed = false;  ///< the host program

 private:
  void run_to(Picoseconds until) {
    while (clock() < until) {
      const bool due = event_ && event_at_ <= until;
      const Picoseconds stop = due ? std::max(event_at_, clock()) : until;
      rig->board.run_until(stop - before_);
      if (due) std::exchange(event_, nullptr)();
    }
  }

  const job::Profile& profile_;
  Picoseconds before_ = 0;  ///< run time of earlier boards
  bool connected_ = true;
  Picoseconds event_at_ = 0;
  std::function<void()> event_;
};

/// A job and how much of each item is done.
class Workpiece {
 public:
  virtual ~Workpiece() = default;
  /// A run of the job begins on this board.
  virtual void begin(const Rig& rig, std::size_t from, std::uint32_t fired) = 0;
  /// Counts what this board has done; called before the board is replaced or after the job.
  virtual void count_done(const Rig& rig) = 0;
  /// The amount of item `i` that was done, and its full amount.
  virtual std::pair<double, double> done(std::size_t i) const = 0;

  job::Profile profile;
  job::Job job;
};

/// Points of one to three flashes, and moves without flashes.
class Points final : public Workpiece {
 public:
  explicit Points(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    profile = lamp_profile(200, LampMode::slave, 10);
    job = job_for(histogram_walk(100 + random() % 700, seed), profile, both_modes[seed % 2]);
    for (wire::Target& target : job.targets)
      if (random() % 4 == 0) target.shots = static_cast<std::uint8_t>(random() % 4);
    job.targets.back().shots = 1;
    fired_.resize(job.size());
  }
  void begin(const Rig& rig, std::size_t from, std::uint32_t fired) override {
    count_done(rig);
    at_ = from;
    flashes_ = fired;
  }
  void count_done(const Rig& rig) override {
    if (&rig != seen_of_) seen_ = 0;
    seen_of_ = &rig;
    for (; seen_ < rig.shots().size(); ++seen_) {
      while (at_ < job.size() && flashes_ >= job.targets[at_].shots) {
        ++at_;
        flashes_ = 0;
      }
      ASSERT_LT(at_, job.size()) << "a shot too many";
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_EQ(rig.board.lattice_shots()[seen_].steps[axis], job.targets[at_].steps[axis])
            << "point " << at_;
      ++fired_[at_];
      ++flashes_;
    }
  }
  std::pair<double, double> done(std::size_t i) const override {
    return {fired_[i], job.targets[i].shots};
  }

 private:
  std::vector<int> fired_;
  const Rig* seen_of_ = nullptr;
  std::size_t seen_ = 0;
  std::size_t at_ = 0;  ///< point of the next shot
  std::uint32_t flashes_ = 0;
};

/// Rows of two lines of pixels each, which run in one motion.
class Rows final : public Workpiece {
 public:
  explicit Rows(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    profile = program_profile();
    profile.settings.set_milli(Id::laser_mode, 1000);
    job.settings = profile.settings;
    const int rows = 3 + static_cast<int>(random() % 6);
    job.header = job::make_header(profile, {}, static_cast<std::size_t>(rows) * lines_of_row);
    job.header.mode = wire::mode_rows;
    for (int row = 0; row < rows; ++row) add_row(row, random);
    light_s_.resize(job.size());
  }
  void begin(const Rig&, std::size_t, std::uint32_t) override {}
  /// Assigns light to the line on which the machine was.
  void count_done(const Rig& rig) override {
    const std::vector<sim::BeamChange> light = rig.board.world().beam().changes();
    const auto &x = rig.monitor.steps(0), &y = rig.monitor.steps(1);
    std::size_t next_y = 0, change = 0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      while (next_y < y.size() && y[next_y].at <= x[i].at) ++next_y;
      const int at_y = next_y == 0 ? 0 : y[next_y - 1].position;
      while (change + 1 < light.size() && light[change + 1].at <= x[i].at) ++change;
      const double lit_s = light_between(light, change, x[i].at, x[i + 1].at);
      if (lit_s == 0) continue;
      const int row = at_y / row_steps - 1;
      ASSERT_EQ(at_y % row_steps, 0) << "light on the way to a row";
      const int line = row * lines_of_row + (x[i].position < line_steps ? 1 : 2);
      ASSERT_LT(static_cast<std::size_t>(line), job.size());
      light_s_[static_cast<std::size_t>(line)] += lit_s;
    }
  }
  std::pair<double, double> done(std::size_t i) const override {
    double wanted_s = 0;
    for (const std::uint16_t run : job.rows.runs_of(job.rows.lines[i]))
      wanted_s += wire::run_power(run) / 65'535.0 * wire::run_cells(run) * cell_s;
    if (wanted_s == 0) return {light_s_[i] == 0 ? 0 : 1, 0};
    // In lines, rounded to a twentieth.
    return {std::round(light_s_[i] / wanted_s * 20) / 20, 1};
  }

 private:
  static constexpr int lines_of_row = 3, row_steps = 40, cells = 20, cell_steps = 40;
  static constexpr int line_steps = cells * cell_steps;
  static constexpr std::uint32_t feed_milli = 3'000'000;  ///< 50 mm/s
  static constexpr double cell_s = cell_steps / 200.0 / 50.0;

  void add_row(int row, std::mt19937_64& random) {
    const int y = (row + 1) * row_steps;
    job.rows.lines.push_back({{{0, y, 0, 0}, false, 0}, job.rows.runs.size(), 0});
    for (int line = 1; line <= 2; ++line) {
      const std::size_t first = job.rows.runs.size();
      for (int cell = 0; cell < cells; ++cell) {
        // Dark where the machine accelerates and brakes, and at the borders between lines.
        const bool dark = cell < 4 || cell >= cells - 4;
        const auto power = static_cast<std::uint16_t>(dark ? 0 : 10'000 + random() % 50'000);
        job.rows.runs.push_back(wire::max_run(power, 1));
      }
      job.rows.lines.push_back({{{line * line_steps, y, 0, 0}, true, feed_milli}, first, cells});
    }
  }
  static double light_between(const std::vector<sim::BeamChange>& light, std::size_t change,
                              Picoseconds from, Picoseconds to) {
    double sum = 0;
    for (; change < light.size() && light[change].at < to; ++change) {
      const auto begin = std::max(from, light[change].at);
      const auto end = change + 1 < light.size() ? std::min(to, light[change + 1].at) : to;
      if (end > begin) sum += sim::seconds(end - begin) * light[change].light() / 65'535.0;
    }
    return sum;
  }

  std::vector<double> light_s_;
};

enum class End {
  none,
  cable,
  killed,
  power,
  killed_then_power,
  watchdog,
  stopped,
  estop,
  reset,
  count
};

/// Options of the command line for the next run.
struct Options {
  bool resume = false;
  std::size_t from = 0;
  std::uint32_t fired = 0;
};

/// The options that the program's message advises.
Options follow(const std::string& text) {
  Options options;
  const auto number = [&text](const std::string& name) {
    const auto at = text.find(name + " ");
    return at == std::string::npos ? 0ul : std::stoul(text.substr(at + name.size() + 1));
  };
  options.resume = text.find("--resume") != std::string::npos;
  if (options.resume) return options;
  EXPECT_THAT(text, HasSubstr("--from "));
  options.from = number("--from");
  options.fired = static_cast<std::uint32_t>(number("--fired"));
  return options;
}

/// One job from beginning to end, with interruptions.
class Story {
 public:
  Story(Workpiece& piece, const std::filesystem::path& journal, std::uint64_t seed)
      : piece_(piece), journal_(journal), random_(seed), bench_(piece.profile) {}

  /// Runs the job with `ends` interruptions and counts them by kind.
  void run(int ends, std::map<End, int>& seen) {
    Options next;
    for (int i = 0; !over_ && i < 50; ++i) {
      const End end = i < ends ? pick_end() : End::none;
      next = run_once(next, end);
      if (testing::Test::HasFatalFailure()) return;
      if (!over_ && end != End::none) ++seen[end];
    }
    ASSERT_TRUE(over_) << "the advice did not finish the job" << log_;
    EXPECT_NE(is_done_, std::filesystem::exists(journal_));
    bench_.run(ps_per_s);
    piece_.count_done(*bench_.rig);
    check();
  }

 private:
  End pick_end() { return static_cast<End>(1 + random_() % (static_cast<int>(End::count) - 1)); }
  Picoseconds up_to(Picoseconds time) {
    return std::uniform_int_distribution<Picoseconds>(0, time)(random_);
  }
  void gone() { piece_.count_done(*bench_.rig); }

  /// Runs `send` with these options to its end; returns the options that it advises.
  Options run_once(const Options& options, End end) {
    options_ = options;
    bench_.killed = bench_.unplugged = false;
    link::KeptJob kept(journal_, piece_.job);
    Continuation rest{options.from, options.fired, options.from, true};
    if (options.resume) {
      EXPECT_EQ(begins_anew(kept), ended_) << "a new start is allowed only after a known end";
      rest = kept.find(bench_);
      ended_ = false;  // until the rest is done, a new start is refused
      continuation_ = {};
      for (std::size_t i = rest.first; i < rest.from; ++i) doubtful_.insert(i);
      if (known_exactly_) {
        EXPECT_LE(rest.from - rest.first, piece_.job.is_rows() ? 1u : 0u);
      }
      over_ = rest.from >= piece_.job.size();
      if (over_) return {};
    } else {
      note_doubt(rest);
    }
    log_ += fmt::format("\n{} {}..{}+{} at {:.3f} s, then {}", options.resume ? "resume" : "from",
                        rest.first, rest.from, rest.flashes, sim::seconds(bench_.clock()),
                        static_cast<int>(end));
    piece_.begin(*bench_.rig, rest.from, rest.flashes);
    unlock();
    kept.begin_at(rest.from, rest.flashes);
    return send(kept, rest, end);
  }

  static bool begins_anew(const link::KeptJob& kept) {
    try {
      kept.require_ended();
      return true;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("--resume"));
      return false;
    }
  }

  /// Records the lines or points that the advice left out and listed as doubtful.
  void note_doubt(const Continuation& rest) {
    for (std::size_t i = continuation_.first; i < rest.from && continuation_.in_doubt(); ++i)
      doubtful_.insert(i);
    continuation_ = {};
  }

  void unlock() {
    if (bench_.rig->state() != MachineState::alarm && bench_.rig->state() != MachineState::estop)
      return;
    bench_.run(200 * ps_per_ms);  // until the e-stop is released
    bench_.type("\n$X\n");
    bench_.run(50 * ps_per_ms);
  }

  Options send(link::KeptJob& kept, const Continuation& rest, End end) {
    job::Job part = piece_.job;
    if (rest.flashes != 0)
      part.targets[rest.from].shots =
          static_cast<std::uint8_t>(part.targets[rest.from].shots - rest.flashes);
    link::SenderOptions options = session(++session_);
    options.reconnect_timeout = std::chrono::seconds(3);
    options.first_fired = rest.flashes;
    options.first_index = part.is_rows() ? job::continue_at(part.rows, rest.from) : rest.from;
    options.run_up_lines = rest.from - options.first_index;
    kept.keep(options);
    link::JobSender sender(bench_, part, options);
    prepare(end, sender);
    std::string advice;
    try {
      while (!bench_.killed && sender.step()) {
      }
    } catch (const Error& error) {
      advice = error.what();
    }
    bench_.forget_event();
    if (bench_.killed) return killed();
    return ended(kept, sender.result(), advice);
  }

  /// The killed program advises nothing; the journal shows whether the board had begun the run.
  Options killed() {
    bench_.run(up_to(4 * ps_per_s));
    bench_.killed = false;
    if (power_follows_) bench_.restart(up_to(ps_per_s), [this] { gone(); });
    const auto contents = job::ProgressJournal(journal_).read();
    // If the board has not accepted a run, the journal still describes the run before it.
    const bool is_taken = contents.run && contents.run->last.session == session_;
    known_exactly_ = (known_exactly_ || is_taken) && !power_follows_ && !restarted_;
    ended_ = !contents.run || contents.run->last.progress == job::Progress::ended;
    if (!contents.empty()) return {true, 0, 0};
    return {};
  }

  Options ended(link::KeptJob& kept, const link::JobResult& result, std::string advice) {
    kept.finish(result);
    log_ += fmt::format(", ended {} at {:.3f} s, {}..{}: {}", static_cast<int>(result.end),
                        sim::seconds(bench_.clock()), result.rest.first, result.rest.from, advice);
    over_ = is_done_ = advice.empty() && result.end == JobEnd::done;
    if (over_) return {};
    if (advice.empty()) advice = link::continuation_text(result.rest, piece_.job.item(), true);
    // A job that was refused before it began restarts with the same options once the cause is gone.
    if (advice.find("--from ") == std::string::npos &&
        advice.find("--resume") == std::string::npos) {
      known_exactly_ = known_exactly_ && !restarted_;
      return options_;
    }
    continuation_ = result.rest;
    ended_ = result.rest.settled;
    known_exactly_ = !restarted_ && (ended_ || result.end == JobEnd::lost);
    bench_.run(up_to(2 * ps_per_s));
    Options next = follow(advice);
    // After any end the journal gives the same place as the message.
    if (next.resume || random_() % 2 == 0) return {true, 0, 0};
    return next;
  }

  /// Schedules the interruption at a random moment.
  void prepare(End end, link::JobSender& sender) {
    power_follows_ = end == End::killed_then_power;
    restarted_ = false;
    if (end == End::none) return;
    // Some are early: in a point or line that the run before had begun.
    const Picoseconds at = bench_.clock() + up_to((random_() % 3 == 0 ? 200 : 2000) * ps_per_ms);
    bench_.at(at, [this, end, &sender] { come(end, sender); });
  }

  void come(End end, link::JobSender& sender) {
    switch (end) {
      case End::cable:
        if (random_() % 2 == 0) bench_.rig->board.set_host_present(false);
        return bench_.pull_cable();
      case End::killed:
      case End::killed_then_power:
        if (random_() % 2 == 0) bench_.rig->board.set_host_present(false);
        bench_.killed = true;
        return;
      case End::power:
        bench_.killed = random_() % 2 == 0;  // by the same power failure
        restarted_ = true;
        return bench_.restart(up_to(4 * ps_per_s), [this] { gone(); });
      case End::watchdog:
        return restart_with_mark();
      case End::stopped:
        return sender.stop();
      case End::estop:
        bench_.rig->press(sim::Pin::estop, bench_.rig->now() + 1,
                          bench_.rig->now() + 100 * ps_per_ms);
        return;
      case End::reset:
        return bench_.type("\x18");
      default:
        return;
    }
  }

  /// The message is that of firmware/boards/rp2040/storage/restart_record.cpp.
  void restart_with_mark() {
    restarted_ = true;
    const machine::ResumePoint mark = bench_.rig->board.controller().job_mark();
    // The hardware fires a shot that it has by itself.
    constexpr Picoseconds ticks_run_out = 900 * ps_per_us;
    if (mark.shot_out) bench_.run(up_to(ticks_run_out));
    bench_.restart(150 * ps_per_ms, [this] { gone(); });
    std::string text = "Started by watchdog";
    if (mark.session == machine::ResumePoint::of_program)
      text += ", programs had run";
    else if (mark.session != 0)
      text += ", job " + std::to_string(mark.session) + " first point not fired " +
              std::to_string(mark.first_unfired) + (mark.shot_out ? ", which may have been" : "");
    machine::Controller& core = bench_.rig->board.controller();
    core.report_message(text);
    if (mark.session != 0) core.start_in_alarm();
    bench_.run(ps_per_ms);
  }

  void check() const {
    SCOPED_TRACE(log_);
    for (std::size_t i = 0; i < piece_.job.size(); ++i) {
      const auto [done, wanted] = piece_.done(i);
      EXPECT_LE(done, wanted) << piece_.job.item() << " " << i;
      if (doubtful_.count(i) == 0) {
        EXPECT_EQ(done, wanted) << piece_.job.item() << " " << i;
      }
    }
  }

  Workpiece& piece_;
  std::filesystem::path journal_;
  std::mt19937_64 random_;
  Bench bench_;
  std::string log_;  ///< the events so far
  std::set<std::size_t> doubtful_;
  Continuation continuation_;
  Options options_;  ///< of the current run
  std::uint32_t session_ = 0x5eed;
  bool over_ = false;
  bool is_done_ = false;  ///< over, and its end was seen
  bool ended_ = true;     ///< the last run has a known end
  bool known_exactly_ = false;
  bool power_follows_ = false, restarted_ = false;
};

/// Runs one job with three interruptions and counts them by kind.
template <class Piece>
void run_story(std::uint64_t seed, std::map<End, int>& seen) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const TemporaryFolder folder;
  Piece piece(seed);
  Story(piece, folder.file("job.llj.progress"), seed).run(3, seen);
}

template <class Piece>
void run_stories(int jobs) {
  std::map<End, int> seen;
  for (int i = 0; i < jobs && !testing::Test::HasFailure(); ++i)
    run_story<Piece>(static_cast<std::uint64_t>(i), seen);
  for (int end = 1; end < static_cast<int>(End::count); ++end)
    if (jobs >= 25) {
      EXPECT_GT(seen[static_cast<End>(end)], 0) << end;
    }
}

/// The cable is cut before the answer to BEGIN arrives; a new start is refused, since the board
/// holds the job. A random story in which this happened.
TEST(Resume, PointsAfterALostAnswerAndANewStart) {
  std::map<End, int> seen;
  run_story<Points>(7102, seen);
}

TEST(Resume, PointsAfterAnyEnd) { run_stories<Points>(scaled(150)); }

TEST(Resume, RowsAfterAnyEnd) { run_stories<Rows>(scaled(50)); }

}  // namespace
}  // namespace lamplock::test::resume_test
