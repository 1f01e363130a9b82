// The machine never moves or fires without a valid job or program.

#include <regex>

#include "tests/board/board_cable.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test::safety_test {
namespace {

/// A frame with a correct checksum and random content.
std::vector<std::uint8_t> random_frame(std::mt19937_64& random) {
  std::uniform_int_distribution<> byte(0, 255), length(0, 60);
  std::vector<std::uint8_t> content(static_cast<std::size_t>(length(random)));
  for (std::uint8_t& b : content) b = static_cast<std::uint8_t>(byte(random));
  // Mostly types that exist, so that their content is parsed.
  if (!content.empty()) content[0] = static_cast<std::uint8_t>(0x40 + byte(random) % 5);
  std::vector<std::uint8_t> frame(2 * (content.size() + wire::crc_size) + 2);
  frame.resize(wire::encode_frame(content, frame));
  return frame;
}

/// The incomplete line at the end of all bytes so far (docs/wire-format.md).
class OpenLine {
 public:
  void add(std::uint8_t byte) {
    constexpr std::uint8_t stx = 0x02, etx = 0x03, reset = 0x18, xon = 0x11, xoff = 0x13;
    if (byte == stx) {
      in_frame_ = true;
      text_.clear();
    } else if (byte == '\r' || byte == '\n' || byte == reset || (in_frame_ && byte == etx)) {
      in_frame_ = false;
      text_.clear();
    } else if (!in_frame_ && byte < 0x80 && byte != 0 && byte != xon && byte != xoff &&
               byte != '?' && byte != '!' && byte != '~') {
      text_ += static_cast<char>(byte);
    }
  }
  /// The line consists of words and comments as a program line does, or is a "$" command.
  bool says_something() const {
    static const std::regex command(R"(\s*\$\s*[A-Za-z0-9].*)");
    static const std::regex comment(R"(\([^)]*\)?|;.*|[\s/%])");  // and ignored characters
    static const std::regex words(R"(([A-Za-z][-+]*[0-9.][-+.0-9]*)+)");
    const bool lost = std::any_of(text_.begin(), text_.end(),
                                  [](char c) { return (c < ' ' && c != '\t') || c == '\x7F'; });
    return !lost && (std::regex_match(text_, command) ||
                     std::regex_match(std::regex_replace(text_, comment, ""), words));
  }

 private:
  std::string text_;
  bool in_frame_ = false;
};

enum class Garbage { bytes, frames, spoilt_frames };

std::vector<std::uint8_t> random_piece(std::mt19937_64& random, Garbage kind) {
  std::uniform_int_distribution<> byte(0, 255), length(1, 64);
  std::vector<std::uint8_t> piece;
  if (kind == Garbage::bytes) {
    for (int n = length(random); n > 0; --n)
      piece.push_back(static_cast<std::uint8_t>(byte(random)));
    return piece;
  }
  piece = random_frame(random);
  if (kind == Garbage::spoilt_frames)
    for (int n = length(random) % 4; n >= 0; --n)
      piece[random() % piece.size()] = static_cast<std::uint8_t>(byte(random));
  return piece;
}

/// Sends bytes that are not a job or a program. One in some thousand random lines is valid, such as
/// "Z9", and may move the machine. Such a line gets a control character, which no valid line has.
void type_garbage(Rig& rig, std::uint64_t seed, int pieces, Garbage kind) {
  std::mt19937_64 random(seed);
  OpenLine line;
  int lines = 0, spoilt = 0;
  for (int i = 0; i < pieces; ++i) {
    std::vector<std::uint8_t> piece;
    for (const std::uint8_t byte : random_piece(random, kind)) {
      if (byte == '\r' || byte == '\n') {
        ++lines;
        if (line.says_something()) {
          piece.push_back('\a');
          ++spoilt;
        }
      }
      line.add(byte);
      piece.push_back(byte);
    }
    rig.board.write(piece);
    rig.run(ps_per_ms);
    std::array<std::uint8_t, 512> answer;
    while (rig.board.read(answer) != 0) {
    }
  }
  EXPECT_LE(spoilt, 2 + lines / 200) << "most lines must be invalid unchanged";
}

TEST(Safety, GarbageNeverMovesNorFires) {
  const job::Profile profile = lamp_profile();
  std::uint64_t seed = 0;
  for (const Garbage kind : {Garbage::bytes, Garbage::frames, Garbage::spoilt_frames}) {
    Rig rig(profile, {.jitter_us = 20, .runt = 0.1, .doubled = 0.05});
    SCOPED_TRACE(testing::Message() << "seed " << ++seed);
    type_garbage(rig, seed, scaled(4000), kind);
    EXPECT_TRUE(rig.monitor.nothing_happened());
    // A '!' or 0x84 among the bytes holds the machine, and a reset ends that; no other effect is
    // permitted.
    const MachineState state = rig.state();
    EXPECT_TRUE(state == MachineState::idle || state == MachineState::hold ||
                state == MachineState::door);
    rig.board.write(std::array<std::uint8_t, 2>{0x18, '\n'});
    rig.run(ps_per_ms);
    EXPECT_EQ(rig.state(), MachineState::idle);
    // A job then runs as usual.
    const job::Job job = job::make_job(histogram_walk(50, 1), profile, {});
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, true));
  }
}

TEST(Safety, WithoutAJobNothingFires) {
  for (const auto mode : {LampMode::slave, LampMode::master, LampMode::free_beat}) {
    const job::Profile profile = lamp_profile(200, mode);
    Rig rig(profile);
    rig.run(20 * ps_per_s);
    EXPECT_TRUE(rig.monitor.nothing_happened());
    const job::Job job = job::make_job(histogram_walk(100, 1), profile, {});
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    const Picoseconds end = rig.now();
    rig.run(20 * ps_per_s);
    EXPECT_EQ(rig.monitor.fired(end, rig.now()), 0u);
    EXPECT_FALSE(rig.monitor.stepped(end, rig.now()));
  }
}

TEST(Safety, ADryJobPassesEveryPointAndFiresNowhere) {
  for (const JoinMode mode : both_modes) {
    const job::Profile profile = lamp_profile();
    job::JobOptions options;
    options.mode = mode;
    options.dry = true;
    const job::Job job = job::make_job(wild_points(150, 3), profile, options);
    Rig rig(profile);
    const link::JobResult result = run_job(rig, job);
    ASSERT_EQ(result.end, JobEnd::done);
    EXPECT_EQ(result.status.first_unfired, job.targets.size());
    EXPECT_TRUE(rig.monitor.fires().empty());
    expect_sound(rig, profile.settings);
    // The motion has the same beats as a firing job: compare with that job's steps.
    job::JobOptions wet_options = options;
    wet_options.dry = false;
    Rig wet(profile);
    ASSERT_EQ(run_job(wet, job::make_job(wild_points(150, 3), profile, wet_options)).end,
              JobEnd::done);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_TRUE(rig.monitor.steps(axis) == wet.monitor.steps(axis)) << axis;
  }
}

/// The machine refuses a job that requires another value, and does not store the value.
void expect_refused(const job::Profile& machine, Id id, std::int32_t milli,
                    const std::string& what) {
  job::Profile asked = machine;
  ASSERT_TRUE(asked.settings.set_milli(id, milli));
  asked.stated.set(static_cast<std::size_t>(id));
  Rig rig(machine);
  EXPECT_THAT(refusal(rig, job::make_job({{1, 1, 0}, {2, 1, 0}}, asked, {})), HasSubstr(what));
  EXPECT_EQ(rig.board.controller().values(), machine.settings) << "stored a refused value";
}
std::string number_of(Id id) { return "$" + std::to_string(settings::row(id).number); }

TEST(Safety, SettingsBeyondTheMachineAreRefusedByNumber) {
  const job::Profile machine = lamp_profile();
  for (int axis = 0; axis < 3; ++axis)
    for (const Id first : {Id::max_rate_x, Id::acceleration_x, Id::travel_x}) {
      const Id id = settings::for_axis(first, axis);
      expect_refused(machine, id, machine.settings.milli(id) + 1, number_of(id));
    }
}

TEST(Safety, AJobCannotWeakenProtections) {
  job::Profile machine = lamp_profile();
  machine.settings.set_milli(Id::lamp_warm_up, 5'000);
  machine.settings.set_milli(Id::max_shot_rate, 150'000);
  machine.settings.set_milli(Id::travel_y, 80'000);
  machine.settings.set_milli(Id::lamp_energy, 8'000);
  machine.settings.set_milli(Id::lamp_power, 900'000);
  machine.settings.set_milli(Id::channels, 5'000);
  for (const Id id : {Id::shutter_open, Id::shutter_close, Id::attenuator_settle})
    machine.settings.set_milli(id, 5'000);
  const std::pair<Id, std::int32_t> loose[] = {
      {Id::soft_limits, 0},        {Id::hard_limits, 0},         {Id::dead_man, 0},
      {Id::dead_man, 2'000'001},   {Id::max_shot_rate, 160'000}, {Id::lamp_warm_up, 4'000},
      {Id::min_corner_x, -50'001}, {Id::min_corner_y, -29'999},  {Id::lamp_energy, 7'999},
      {Id::lamp_energy, 0},        {Id::lamp_power, 900'001},    {Id::channels, 2'000},
      {Id::channels, 15'000},      {Id::shutter_open, 4'999},    {Id::shutter_close, 0},
      {Id::attenuator_settle, 0}};
  for (const auto& [id, value] : loose) expect_refused(machine, id, value, number_of(id));
}

/// The machine defines how a lamp may be triggered: a job cannot make the board its master, trigger
/// it faster, or use another energy than the machine's.
TEST(Safety, AJobCannotChangeHowTheLampIsTriggered) {
  struct Case {
    LampMode machine, job;
    double job_hz;
    bool dry;
    const char* refused;  ///< empty if the job runs
  };
  const Case cases[] = {
      {LampMode::slave, LampMode::master, 100, false, "$900"},
      {LampMode::slave, LampMode::master, 100, true, "$900"},
      {LampMode::slave, LampMode::free_beat, 100, false, "$900"},
      {LampMode::slave, LampMode::free_beat, 201, true, "$901"},
      {LampMode::slave, LampMode::free_beat, 200, true, ""},
      {LampMode::master, LampMode::free_beat, 100, false, "$900"},
      {LampMode::master, LampMode::master, 201, false, "$901"},
      {LampMode::master, LampMode::master, 200, false, ""},
      {LampMode::free_beat, LampMode::master, 100, false, "$900"},
      {LampMode::free_beat, LampMode::free_beat, 1000, false, ""},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(testing::Message() << static_cast<int>(c.machine) << " " << static_cast<int>(c.job)
                                    << " " << c.job_hz << " Hz" << (c.dry ? " dry" : ""));
    const job::Profile machine = lamp_profile(100, c.machine);
    job::Profile asked = machine;
    job::state_setting(asked, Id::lamp_mode, static_cast<int>(c.job), "test");
    job::state_setting(asked, Id::lamp_frequency, c.job_hz, "test");
    job::JobOptions options;
    options.dry = c.dry;
    const job::Job job = job::make_job(histogram_walk(20, 1), asked, options);
    Rig rig(machine);
    if (*c.refused == 0) {
      EXPECT_EQ(run_job(rig, job).end, JobEnd::done);
      continue;
    }
    EXPECT_THAT(refusal(rig, job), HasSubstr(c.refused));
  }
}

TEST(Safety, ALampIsNotTriggeredBeyondItsLimits) {
  Rig rig(lamp_profile(100));
  ProgramHost host(rig);
  const auto refused = ElementsAre(HasSubstr("contradicts other settings"), "error:52");
  const auto taken = ElementsAre("ok");
  EXPECT_THAT(host.ask("$900=2\n"), refused) << "the energy of a flash is unknown";
  EXPECT_THAT(host.ask("$922=20.001\n"), refused);
  EXPECT_THAT(host.ask("$923=100000\n"), ElementsAre("error:52")) << "outside of its range";
  EXPECT_THAT(host.ask("$922=4\n"), taken);
  EXPECT_THAT(host.ask("$900=2\n"), taken);
  EXPECT_THAT(host.ask("$901=5000\n"), refused);
  EXPECT_THAT(host.ask("$901=200\n"), taken);
  EXPECT_THAT(host.ask("$910=1\n"), refused) << "triggers would come at 202 Hz";
  EXPECT_THAT(host.ask("$922=5.1\n"), refused) << "1020 W";
  EXPECT_THAT(host.ask("$922=0\n"), refused);
  EXPECT_THAT(host.ask("$935=3\n"), refused) << "a flash has 4 J";
}

TEST(Safety, AJobBeyondTheLasersLimitsIsRefused) {
  const job::Profile machine = lamp_profile();
  job::Profile asked = machine;
  job::state_setting(asked, Id::lamp_energy, 10.001, "test");  // at 100 Hz
  Rig rig(machine);
  EXPECT_THAT(refusal(rig, job::make_job(histogram_walk(20, 1), asked, {})), HasSubstr("$922"));
  asked = machine;
  job::state_setting(asked, Id::shot_check, 2, "test");
  job::state_setting(asked, Id::sensor_time, 9'000, "test");
  EXPECT_THAT(refusal(rig, job::make_job(histogram_walk(20, 1), asked, {})), HasSubstr("$929"));
}

TEST(Safety, AChannelThatMayNotFireIsRefusedByPoint) {
  job::Profile machine = lamp_profile();
  machine.settings.set_milli(Id::channels, 5'000);  // first and third
  job::Job job = job::make_job(histogram_walk(200, 1), machine, {});
  for (std::size_t i = 0; i < job.targets.size(); ++i) job.targets[i].channel = i % 2 == 0 ? 0 : 2;
  Rig good(machine);
  EXPECT_EQ(run_job(good, job).end, JobEnd::done);
  job.targets[117].channel = 3;
  Rig rig(machine);
  EXPECT_THROW(
      {
        try {
          run_job(rig, job);
        } catch (const Error& error) {
          EXPECT_THAT(error.what(), HasSubstr("point 117"));
          throw;
        }
      },
      Error);
  for (const sim::Shot& shot : rig.shots()) EXPECT_NE(shot.channel, 3);
}

TEST(Safety, OverridesEndWithTheJob) {
  const job::Profile machine = lamp_profile();
  job::Profile asked = machine;
  job::state_setting(asked, Id::lamp_mode, static_cast<int>(LampMode::free_beat), "test");
  Rig rig(machine);
  const EdgeLog trigger(rig.board.bus(), sim::Pin::lamp_trigger);
  job::JobOptions moves_only;
  moves_only.dry = true;
  const job::Job job = job::make_job(histogram_walk(20, 1), asked, moves_only);
  for (std::uint32_t number = 1; number <= 2; ++number) {
    ASSERT_EQ(run_job(rig, job, session(number)).end, JobEnd::done);
    rig.run(10 * ps_per_ms);
    EXPECT_EQ(rig.board.controller().values(), machine.settings);
    // The machine's own lamp gives the beat again, and the board does not trigger it.
    const std::size_t in_the_job = trigger.edges().size();
    EXPECT_GT(in_the_job, std::size_t{20} * number);
    rig.run(300 * ps_per_ms);
    EXPECT_EQ(trigger.edges().size(), in_the_job);
    EXPECT_FALSE(rig.board.bus().level(sim::Pin::lamp_trigger));
    EXPECT_TRUE(rig.board.controller().clock().locked());
  }
}

TEST(Safety, AJobCannotChangeSettingsOfTheMachine) {
  const job::Profile machine = lamp_profile();
  const std::pair<Id, std::int32_t> other[] = {{Id::steps_per_mm_x, 400'000},
                                               {Id::steps_per_mm_y, 199'999},
                                               {Id::steps_per_mm_z, 201'000},
                                               {Id::steps_per_mm_a, 100'000},
                                               {Id::axes, 2'000},
                                               {Id::axes, 4'000},
                                               {Id::pulse_mode_y, 1'000},
                                               {Id::step_invert, 2'000},
                                               {Id::direction_invert, 1'000},
                                               {Id::enable_invert, 1'000},
                                               {Id::direction_setup, 400},
                                               {Id::direction_hold, 5'000},
                                               {Id::step_pulse, 400}};
  // $0 cannot be reported: 0 means that a refusal is not about a setting.
  for (const auto& [id, value] : other)
    expect_refused(machine, id, value,
                   "machine: " + (id == Id::step_pulse ? "the job header" : number_of(id)));
}

TEST(Safety, AJobMayLowerLimitsUntilItEnds) {
  const job::Profile machine = lamp_profile();
  job::Profile slower = machine;
  job::set_speed(slower, 0.005);
  job::set_acceleration(slower, 0.2);
  Rig rig(machine);
  const job::Job slow = job::make_job(histogram_walk(60, 1), slower, {});
  ASSERT_EQ(run_job(rig, slow).end, JobEnd::done);
  EXPECT_EQ(rig.monitor.violation(slower.settings), "");
  const Picoseconds slow_time = rig.now();
  job::Job plain = job::make_job(histogram_walk(60, 1), machine, {});
  plain.header.override_count = 0;
  ASSERT_EQ(run_job(rig, plain, session(2)).end, JobEnd::done);
  EXPECT_LT(rig.now() - slow_time, slow_time / 2);
}

TEST(Safety, JobsForAnotherMachineAreRefused) {
  const job::Profile machine = lamp_profile();
  const geometry::PointCloud points = histogram_walk(20, 1);
  {
    job::Job job = job::make_job(points, machine, {});
    job.header.override_count = 0;
    job.header.axes = 2;
    for (wire::Target& target : job.targets) target.steps[2] = 0;
    Rig rig(machine);
    EXPECT_THAT(refusal(rig, job), HasSubstr("$960"));
  }
  {
    job::JobOptions options;
    options.check_settings = true;
    job::Job job = job::make_job(points, machine, options);
    job.header.settings_hash ^= 1;
    Rig rig(machine);
    EXPECT_THAT(refusal(rig, job), HasSubstr("other settings"));
  }
  {
    // A corner's speed is limited by the machine's own setting.
    job::Profile faster = machine;
    job::state_setting(faster, Id::speed_jump_y, 0.5, "test");
    Rig rig(machine);
    EXPECT_THAT(refusal(rig, job::make_job(points, faster, {})), HasSubstr("$962"));
  }
  {
    job::Job job = job::make_job(points, machine, {});
    job.header.overrides[job.header.override_count++] = {9999, 1};
    Rig rig(machine);
    EXPECT_THAT(refusal(rig, job), HasSubstr("the machine does not allow"));
  }
}

TEST(Safety, PointsOutsideTheWorkSpaceAreRefusedByTheFirmwareToo) {
  const job::Profile machine = lamp_profile();
  job::Profile larger = machine;
  for (int axis = 0; axis < 3; ++axis) {
    job::state_setting(larger, settings::for_axis(Id::travel_x, axis), 200, "test");
    job::state_setting(larger, settings::for_axis(Id::min_corner_x, axis), -100, "test");
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-50.005, 50.005}) {
      geometry::PointCloud points(10, {1, 1, 1});
      double& v = axis == 0 ? points[7].x : axis == 1 ? points[7].y : points[7].z;
      v = side;
      job::Job job = job::make_job(points, larger, {});
      job.header.override_count = 0;  // the machine's own work space applies
      Rig rig(machine);
      EXPECT_THAT(refusal(rig, job), StartsWith("error: point 7: is outside"));
    }
  }
}

}  // namespace
}  // namespace lamplock::test::safety_test
