// A test machine whose board is the real flash image on the simulated chip: board, world, monitors
// of its pins, and a user at its USB cable.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "host/error.hpp"
#include "shared/boards/this_board.hpp"
#include "sim/chip/profile/function_table.hpp"
#include "sim/chip_board/chip_board.hpp"
#include "tests/board/rig.hpp"
#include "tests/flash_image_path.hpp"
#include "tests/program_sender.hpp"

namespace lamplock::test {

/// The image under test, read once.
inline const sim::chip::Image& flash_image() {
  static const sim::chip::Image image = sim::chip::load_image(flash_image_path());
  return image;
}

/// A fast lamp, so that short jobs end soon.
inline job::Profile chip_profile(double lamp_hz = 500) {
  job::Profile profile = job::default_profile();
  job::set_lamp_hz(profile, lamp_hz);
  return profile;
}

/// A PC that finds a device at once.
inline sim::ChipBoardOptions quick_host() {
  sim::ChipBoardOptions options;
  options.usb.debounce = 2 * ps_per_ms;
  options.usb.reset = 3 * ps_per_ms;
  options.usb.reset_recovery = ps_per_ms;
  return options;
}

/// Points at small distances, for a fast lamp.
inline geometry::PointCloud chip_points(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<> step(-0.05, 0.05);
  geometry::PointCloud cloud{{0, 0, 0}};
  while (cloud.size() < count) {
    geometry::Point p = cloud.back();
    p.x += step(random), p.y += step(random), p.z += step(random);
    cloud.push_back(p);
  }
  return cloud;
}

/// Watches the pads that can release energy, whatever drives them.
class EnergyPads final : public sim::chip::PadListener {
 public:
  struct Edge {
    unsigned gpio;
    bool level;
    Picoseconds at;
  };
  static constexpr unsigned q_switch = boards::gpio(boards::Role::q_switch);
  static constexpr unsigned trigger = boards::gpio(boards::Role::lamp_trigger);
  static constexpr unsigned gate = boards::gpio(boards::Role::laser_gate);
  static constexpr unsigned arm = boards::gpio(boards::Role::shot_enable);
  static constexpr unsigned pwm = boards::gpio(boards::Role::laser_pwm);
  static constexpr std::uint32_t all =
      1u << q_switch | 1u << trigger | 1u << gate | 1u << arm | 1u << pwm;

  explicit EnergyPads(sim::chip::Chip& chip) : chip_(chip) { chip.gpio().listen(*this); }
  EnergyPads(const EnergyPads&) = delete;
  EnergyPads& operator=(const EnergyPads&) = delete;

  void pad_changed(unsigned gpio, bool level, sim::chip::Cycle at) override {
    if ((all >> gpio & 1) == 0) return;
    edges_.push_back({gpio, level, chip_.wheel().time_of(at)});
  }
  std::uint32_t levels() const { return chip_.gpio().pad_levels() & all; }
  /// Whether a pad was high at any time in [from, to].
  bool high_within(unsigned gpio, Picoseconds from, Picoseconds to) const {
    bool level = false;
    for (const Edge& edge : edges_) {
      if (edge.gpio != gpio) continue;
      if (edge.at > to) break;
      if (edge.at > from && (level || edge.level)) return true;
      level = edge.level;
    }
    return level;
  }
  bool any_high_within(Picoseconds from, Picoseconds to) const {
    for (const unsigned gpio : {q_switch, trigger, gate, arm, pwm})
      if (high_within(gpio, from, to)) return true;
    return false;
  }

 private:
  sim::chip::Chip& chip_;
  std::vector<Edge> edges_;
};

/// The board with its monitors. The simulator must find no violation up to the end, unless a test
/// breaks the board on purpose (is_broken).
struct ChipRig {
  enum class Power { on, off };

  explicit ChipRig(const job::Profile& machine = chip_profile(), Power power = Power::on)
      : ChipRig(machine.settings, world_for(machine), power) {}
  ChipRig(const settings::Values& stored, const sim::WorldConfig& world, Power power = Power::on,
          const sim::chip::Image& image = flash_image(),
          const sim::ChipBoardOptions& options = quick_host())
      : board(image, stored, world, options),
        monitor(board.bus(), board.world().lamp()),
        energy(board.chip()) {
    if (power == Power::on) boot();
  }
  ChipRig(const ChipRig&) = delete;
  ChipRig& operator=(const ChipRig&) = delete;
  ~ChipRig() {
    if (is_broken) return;
    EXPECT_THAT(board.chip().usb().violations(), IsEmpty());
    EXPECT_THAT(board.usb_host().violations(), IsEmpty());
    EXPECT_THAT(board.chip().not_modelled(), IsEmpty());
    EXPECT_EQ(board.world().drives().total_faults(), 0u);
  }

  /// Length of a system clock, after boot.
  Picoseconds clock() {
    return ps_per_s /
           static_cast<Picoseconds>(board.chip().system().clocks.hz(sim::chip::Clock::sys));
  }

  bool is_broken = false;
  sim::ChipBoard board;
  PinMonitor monitor;
  EnergyPads energy;
  ProgramSender user{board};
  /// Text from the machine so far.
  std::string& heard = user.heard;

  sim::chip::Core& core() { return board.chip().core(0); }
  Picoseconds now() const { return board.now(); }
  void run(Picoseconds time) { board.run_until(now() + time); }
  /// Changes an input of the board now.
  void set(sim::Pin pin, bool level) { board.world().schedule(pin, level, now()); }
  /// An input is active for some time.
  void press(sim::Pin pin, Picoseconds from, Picoseconds to) {
    board.world().schedule(pin, true, from);
    board.world().schedule(pin, false, to);
  }
  /// Runs until the serial port exists and has sent the banner and the messages of the start.
  void boot() {
    if (!board.run_until_found(ps_per_s)) throw std::runtime_error("the board is not found");
    run(10 * ps_per_ms);
    listen();
  }
  void listen() { user.listen(); }
  /// Returns the number of characters that the PC's buffers accepted.
  std::size_t type(std::string_view text) { return user.send_some(text); }
  std::string status() { return user.status(); }
  std::string answer(std::string_view line, Picoseconds limit = 600 * ps_per_ms) {
    return user.answer(line, limit);
  }
  /// Position as the board reports it, mm.
  std::array<double, max_axes> reported_mm(const settings::Values& values) {
    const std::string line = status();
    std::array<double, max_axes> place{};
    std::size_t at = line.find("MPos:");
    if (at == std::string::npos) {
      ADD_FAILURE() << "no position in " << line;
      return place;
    }
    at += 5;
    for (int axis = 0; axis < values.whole(Id::axes); ++axis) {
      std::size_t used = 0;
      place[static_cast<std::size_t>(axis)] = std::stod(line.substr(at), &used);
      at += used + 1;
    }
    return place;
  }
  /// The reported position in steps.
  StepPosition reported_position(const settings::Values& values) {
    const std::array<double, max_axes> place = reported_mm(values);
    StepPosition steps{};
    for (int axis = 0; axis < values.whole(Id::axes); ++axis)
      steps[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(std::lround(
          place[static_cast<std::size_t>(axis)] * values.milli(Id::steps_per_mm_x, axis) / 1000.0));
    return steps;
  }
  Picoseconds last_step() const { return monitor.last_step(); }
  const sim::Shots& shots() const { return board.world().laser().shots(); }
  bool step_high() {
    for (int axis = 0; axis < 3; ++axis)
      if (board.bus().level(sim::step_pin(axis))) return true;
    return false;
  }
};

/// Whether the second core is in the middle of a plan.
inline bool plans(ChipRig& rig) { return !rig.board.chip().core(1).idle(); }

/// The second core plans and is not only awake: its program counter is in a planner's function.
inline bool in_a_slice(ChipRig& rig) {
  static const sim::chip::FunctionTable functions(flash_image().symbols);
  const std::size_t at = functions.find(rig.board.chip().core(1).reg(15));
  return at != functions.size() &&
         functions[at].name.find("lamplock::motion::") != std::string::npos;
}

/// Runs into a plan; false if none begins within a second. The host sends nothing meanwhile.
inline bool run_into_a_plan(ChipRig& rig) {
  for (int i = 0; i < 100'000 && !in_a_slice(rig); ++i) rig.run(10 * ps_per_us);
  return in_a_slice(rig);
}

/// Tests of a machine after power-up, with random moments.
class BootedRig : public testing::Test {
 protected:
  explicit BootedRig(std::uint64_t seed) : random_(seed) {}
  void SetUp() override { boot_anew(); }
  /// Boots a new machine of the same kind.
  void boot_anew() { rig_.emplace(profile_); }
  ChipRig& rig() { return *rig_; }
  Picoseconds up_to(Picoseconds most) {
    return std::uniform_int_distribution<Picoseconds>(0, most)(random_);
  }

  const job::Profile profile_ = chip_profile();
  std::mt19937_64 random_;

 private:
  std::optional<ChipRig> rig_;
};

/// Opens the gate of a continuous laser as a job would: sets the gate's bit in all filled lattice
/// words and releases its pad. The firmware does not undo this until it enables or disables the
/// laser.
inline void open_gate(ChipRig& rig) {
  constexpr std::uint32_t bits_ring_channel = 0x5000'0100;  // DMA CH4_READ_ADDR
  constexpr std::uint32_t ring_bytes = 2048, gate_of_8_ticks = 0x2222'2222;
  using sim::chip::Master;
  using sim::chip::Width;
  sim::chip::Bus& bus = rig.board.chip().bus();
  const sim::chip::Cycle now = rig.board.chip().now();
  const std::uint32_t ring =
      bus.read(bits_ring_channel, Width::word, Master::dma, now).value & ~(ring_bytes - 1);
  for (std::uint32_t at = ring; at < ring + ring_bytes; at += 4)
    bus.write(at, bus.read(at, Width::word, Master::dma, now).value | gate_of_8_ticks, Width::word,
              Master::dma, now);
  constexpr std::uint32_t gate_control = 0x4001'4004 + 8 * EnergyPads::gate;  // GPIO_CTRL
  constexpr std::uint32_t override_bits = 3u << 8;                            // OUTOVER
  bus.write(gate_control,
            bus.read(gate_control, Width::word, Master::core0, now).value & ~override_bits,
            Width::word, Master::core0, now);
}

/// The cable between a sender and the board, with actions at given times.
class ChipCable final : public link::Transport {
 public:
  explicit ChipCable(ChipRig& rig) : rig_(rig) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    return rig_.board.write(bytes);
  }
  std::size_t read(std::span<std::uint8_t> bytes) override { return rig_.board.read(bytes); }
  void wait(std::chrono::microseconds time) override {
    const Picoseconds until = rig_.now() + time.count() * ps_per_us;
    while (rig_.now() < until && !rig_.board.has_output())
      run_until(std::min(until, rig_.now() + ps_per_ms));
  }
  std::chrono::microseconds now() const override {
    return std::chrono::microseconds(rig_.now() / ps_per_us);
  }
  bool connected() const override {
    return rig_.board.usb_host().enumerated() || rig_.board.usb_host().suspended();
  }
  bool reconnect() override { return rig_.board.usb_host().enumerated(); }

  /// Calls `action` when the board's clock shows `at`.
  void at(Picoseconds at, std::function<void()> action) { actions_.emplace(at, std::move(action)); }
  /// Runs the board and the actions that are due.
  void run_until(Picoseconds until) {
    while (!actions_.empty() && actions_.begin()->first <= until) {
      rig_.board.run_until(actions_.begin()->first);
      const auto action = std::move(actions_.begin()->second);
      actions_.erase(actions_.begin());
      action();
    }
    rig_.board.run_until(until);
  }

 private:
  ChipRig& rig_;
  std::multimap<Picoseconds, std::function<void()>> actions_;
};

/// A job on a rig, sent by a host.
struct RunningJob {
  RunningJob(ChipRig& machine, const job::Job& what, std::uint32_t session, std::size_t first = 0)
      : rig(machine), job(what), cable(machine), sender(cable, job, options(session, first)) {}
  static link::SenderOptions options(std::uint32_t session, std::size_t first) {
    link::SenderOptions options;
    options.auto_resume = true;  // tests send stops as noise would
    options.session = session;
    options.first_index = first;
    options.reply_timeout = std::chrono::milliseconds(30);
    options.status_interval = std::chrono::milliseconds(20);
    return options;
  }
  /// Longer than any job here: its points at several beats of the slowest lamp.
  Picoseconds limit() const {
    return 3 * ps_per_s + static_cast<Picoseconds>(job.targets.size()) * 60 * ps_per_ms;
  }
  /// Runs until `shots` more were fired; false if the job ends before or stalls.
  bool run_until_fired(std::size_t shots) {
    const std::size_t wanted = rig.shots().size() + shots;
    const Picoseconds end = rig.now() + limit();
    while (rig.shots().size() < wanted)
      if (rig.now() > end || !sender.step()) return false;
    return true;
  }
  /// Runs to the end of the job; fails the test if it does not end.
  JobEnd finish() {
    const Picoseconds end = rig.now() + limit();
    while (sender.step())
      if (rig.now() > end) {
        ADD_FAILURE() << "the job does not end; " << rig.shots().size() << " shots";
        break;
      }
    return sender.result().end;
  }
  /// Runs until a moment, to the picosecond; false if the job ends before.
  bool run_until(Picoseconds moment) {
    bool there = false;
    cable.at(moment, [&there] { there = true; });
    while (!there && rig.now() < moment - ps_per_ms)
      if (!sender.step()) return false;
    if (!there) cable.run_until(moment);
    return true;
  }

  ChipRig& rig;
  job::Job job;
  ChipCable cable;
  link::JobSender sender;
};

/// The points from the first one on were fired once, in order, each at its place, as far as the job
/// has come. Steps are counted when they are output, and a point may lie exactly at a step.
inline void expect_fired_so_far(const ChipRig& rig, const job::Job& job, std::size_t first_shot = 0,
                                std::size_t first_point = 0) {
  const sim::Shots& shots = rig.shots();
  ASSERT_LE(shots.size() - first_shot, job.targets.size() - first_point);
  for (std::size_t i = first_shot; i < shots.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_NEAR(shots[i].steps[axis], job.targets[first_point + i - first_shot].steps[axis], 1)
          << "shot " << i << " axis " << axis;
}

/// As expect_fired_so_far(), and every point was fired.
inline void expect_fired(const ChipRig& rig, const job::Job& job, std::size_t first_shot = 0,
                         std::size_t first_point = 0) {
  ASSERT_EQ(rig.shots().size() - first_shot, job.targets.size() - first_point);
  expect_fired_so_far(rig, job, first_shot, first_point);
}

/// Runs a job to its end; every point was fired once, in order, at its place.
inline void run_to_the_end(ChipRig& rig, const job::Job& job, std::uint32_t session = 1) {
  const std::size_t fired = rig.shots().size();
  ASSERT_EQ(RunningJob(rig, job, session).finish(), JobEnd::done);
  expect_fired(rig, job, fired);
}

inline constexpr Picoseconds ps_per_tick = ps_per_us;
/// From the tick to STEP on its pad (firmware: step_latency_clocks; found again by the first step)
/// at 125 MHz; at 200 MHz it is 30 ns. Either is far less than a tick.
inline constexpr Picoseconds step_latency = 6 * 8 * ps_per_ns;

/// A step: its axis, tick and direction, counted from the lamp edge of the first shot. The lamp is
/// steady and nominal, so that a tick is a microsecond.
using Step = std::tuple<int, std::int64_t, std::int32_t>;

inline std::vector<Step> steps_of(const PinMonitor& monitor, Picoseconds latency) {
  std::vector<Step> steps;
  const Picoseconds start = monitor.fires().front().edge;
  for (int axis = 0; axis < 3; ++axis)
    for (const PinMonitor::Step& step : monitor.steps(axis)) {
      const Picoseconds at = step.at - latency - start + ps_per_tick / 2;
      steps.emplace_back(axis, at / ps_per_tick - (at < 0 ? 1 : 0), step.position);
    }
  return steps;
}

}  // namespace lamplock::test
