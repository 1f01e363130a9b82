// The CPU hangs, faults or loses power at random moments of a job: its outputs end by themselves,
// the reason is reported after the restart, and nothing happens before a new job.
#include "tests/chip_board/chip_rig.hpp"
#include "tests/figure.hpp"

namespace lamplock::test::hang_test {
namespace {

using sim::chip::Master;
using sim::chip::Width;

/// Unused memory: the stack of core 1 never reaches it.
constexpr std::uint32_t spare = 0x2004'0000;
constexpr Picoseconds contract = ps_per_ms;

/// Kinds of CPU failure.
enum class End : std::uint8_t {
  spins_deaf,    ///< a loop with interrupts off
  spins_in_isr,  ///< a loop at the level of the interrupt that feeds the ticks
  undefined,     ///< an instruction that does not exist
  bad_load,      ///< a load from an address without a device
  bad_jump,      ///< a jump to an address without code
  locked_up,     ///< a fault with no stack left
  count
};
constexpr bool is_fault(End end) { return end >= End::undefined && end <= End::bad_jump; }

class Loss : public BootedRig {
 protected:
  Loss() : BootedRig(11) {}
  void put(std::uint32_t address, std::uint16_t instruction) {
    rig().board.chip().bus().write(address, instruction, Width::half, Master::core0,
                                   rig().core().cycle());
  }
  /// Returns after the CPU has failed. A fault occurs only when the core reaches the instruction
  /// put under it: a core that sleeps or is about to be interrupted serves the interrupt first, and
  /// its records are stored.
  void lose(End end, int id = 0) {
    sim::chip::Core& core = rig().board.chip().core(id);
    constexpr std::uint16_t loop = 0xe7fe, undefined = 0xde00, load_r0 = 0x6800;
    put(spare, end == End::undefined ? undefined : end == End::bad_load ? load_r0 : loop);
    constexpr std::uint32_t nowhere = 0x3000'0000;
    if (end == End::spins_deaf) core.set_primask(true);
    constexpr unsigned hard_fault = 3, timer_1 = 16 + 1;
    if (end == End::spins_in_isr) run_until_in(core, timer_1);
    if (end == End::bad_load) core.set_reg(0, nowhere);
    if (end == End::locked_up) core.set_reg(13, nowhere);
    core.set_reg(15, end == End::bad_jump || end == End::locked_up ? nowhere : spare);
    if (is_fault(end)) run_until_in(core, hard_fault);
  }
  /// Runs up to the entry of an exception.
  void run_until_in(const sim::chip::Core& core, unsigned exception) {
    sim::chip::Chip& chip = rig().board.chip();
    for (int i = 0; i < 200'000 && core.exception() != exception; ++i)
      chip.run_until(chip.now() + 1);
    EXPECT_EQ(core.exception(), exception);
  }
  /// Runs until the watchdog has restarted the chip once; a plan may take a second.
  void restart() {
    const Picoseconds lost = rig().now();
    for (int i = 0; i < 1200 && rig().board.chip().watchdog_resets() == 0; ++i)
      rig().run(ps_per_ms);
    restarted_after_ = std::max(restarted_after_, rig().now() - lost);
    rig().run(30 * ps_per_ms);  // the host detects the disconnect
    rig().boot();
    rig().run(20 * ps_per_ms);
    rig().listen();
    EXPECT_EQ(rig().board.chip().watchdog_resets(), 1u);
  }
  Picoseconds restarted_after_ = 0;  ///< the longest of all calls of restart()

  /// The message about a job; `may_have_been`: its shot was handed to the hardware.
  static std::string rest_message(std::uint32_t session, std::size_t first_unfired,
                                  bool may_have_been) {
    return "job " + std::to_string(session) + " first point not fired " +
           std::to_string(first_unfired) + (may_have_been ? ", which may have been]" : "]");
  }
};

TEST_F(Loss, OfTheProcessorAtRandomMoments) {
  Picoseconds longest = 0, dark_after = 0;
  for (int round = 0; round < scaled(static_cast<int>(End::count), static_cast<int>(End::count));
       ++round) {
    const auto end = static_cast<End>(round % static_cast<int>(End::count));
    SCOPED_TRACE(testing::Message() << "round " << round);
    if (round > 0) {
      ASSERT_NO_FATAL_FAILURE(boot_anew());
    }
    const auto session = static_cast<std::uint32_t>(100 + round);
    const job::Job job = job::make_job(chip_points(60, random_()), profile_, {});
    RunningJob running(rig(), job, session);
    ASSERT_TRUE(running.run_until_fired(2 + random_() % 12));
    open_gate(rig());
    rig().run(ps_per_ms + up_to(2 * ps_per_ms));
    lose(end);
    const Picoseconds lost = rig().now();
    const std::size_t shots_before = rig().shots().size();
    const auto lights = EnergyPads::all & ~(1u << EnergyPads::q_switch);
    while (is_fault(end) && (rig().energy.levels() & lights) != 0 && rig().now() < lost + contract)
      rig().run(ps_per_us / 20);
    if (is_fault(end)) dark_after = std::max(dark_after, rig().now() - lost);
    rig().board.run_until(lost + contract);
    const auto steps_at_loss = rig().board.world().drives().position();
    const std::size_t shots = rig().shots().size();
    rig().run(60 * ps_per_ms);
    // A pulse that has begun ends by itself.
    for (const unsigned gpio :
         {EnergyPads::gate, EnergyPads::arm, EnergyPads::pwm, EnergyPads::trigger})
      EXPECT_FALSE(rig().energy.high_within(gpio, lost + contract, rig().now())) << "pad " << gpio;
    EXPECT_FALSE(rig().energy.high_within(EnergyPads::q_switch, lost + contract + 200 * ps_per_us,
                                          rig().now()));
    EXPECT_FALSE(rig().step_high());
    longest = std::max(longest, rig().last_step() - lost);
    running.sender.stop();
    ASSERT_NO_FATAL_FAILURE(restart());
    EXPECT_THAT(rig().heard, HasSubstr(is_fault(end) ? "[MSG:Started by fault, pc 0x"
                                                     : "[MSG:Started by watchdog"));
    // The hardware may fire a shot that it has after the processor has failed, and a fired shot may
    // be missing in the record.
    if (shots > shots_before)
      EXPECT_THAT(rig().heard, HasSubstr(rest_message(session, shots - 1, true)));
    else
      EXPECT_THAT(rig().heard, AnyOf(HasSubstr(rest_message(session, shots, false)),
                                     HasSubstr(rest_message(session, shots, true)),
                                     HasSubstr(rest_message(session, shots - 1, true))));
    EXPECT_THAT(rig().heard, HasSubstr("ALARM:3"));
    EXPECT_THAT(rig().status(), HasSubstr("<Alarm"));
    EXPECT_EQ(rig().board.world().drives().position(), steps_at_loss);
    EXPECT_EQ(rig().shots().size(), shots);
    // The rest of the job, by a host that unlocks first.
    RunningJob locked(rig(), job, session + 1, shots);
    EXPECT_ANY_THROW(locked.sender.run());
    // A STATUS of the refused job may come before it.
    EXPECT_THAT(rig().answer("$X"), testing::EndsWith("[MSG:Caution: Unlocked]\r\nok\r\n"));
  }
  expect_figure("last step after the loss of the processor", longest, 0, 0.93);
  expect_figure("energy outputs low after the entry of a fault", dark_after, 0, 0.001);
  // The test itself adds 60 ms before it waits.
  expect_figure("restart after the loss", restarted_after_ + 60 * ps_per_ms, 60, 110);
}

/// The processor fails shortly before the shot of the next beat: the hardware fires it, and the
/// record says that it may have been fired.
TEST_F(Loss, WithAShotInTheHardware) {
  geometry::PointCloud cloud;
  for (int i = 0; i < 60; ++i) cloud.push_back({0.005 * i, 0, 0});
  RunningJob running(rig(), job::make_job(cloud, profile_, {}), 1);
  ASSERT_TRUE(running.run_until_fired(8));
  const std::size_t seen = rig().shots().size();
  ASSERT_EQ(rig().shots()[seen - 1].beat - rig().shots()[seen - 2].beat, 1u)
      << "a shot in each beat";
  const Picoseconds beat = rig().shots()[seen - 1].at - rig().shots()[seen - 2].at;
  std::size_t shots = 0;
  running.cable.at(rig().shots()[seen - 1].at + 2 * beat - 300 * ps_per_us, [&] {
    shots = rig().shots().size();
    lose(End::spins_deaf);
  });
  while (shots == 0 && running.sender.step()) {
  }
  ASSERT_EQ(shots, seen + 1);
  running.sender.stop();
  ASSERT_NO_FATAL_FAILURE(restart());
  EXPECT_EQ(rig().shots().size(), shots + 1);
  EXPECT_THAT(rig().heard, HasSubstr(rest_message(1, shots, true)));
}

/// Only the watchdog waits for the second core; the e-stop does not.
TEST_F(Loss, OfTheSecondCoreInAPlan) {
  const End ends[] = {End::spins_deaf, End::undefined, End::locked_up, End::bad_load,
                      End::bad_jump};
  for (int round = 0; round < scaled(5, 5); ++round) {
    const End end = ends[round % 5];
    SCOPED_TRACE(testing::Message() << "round " << round);
    if (round > 0) {
      ASSERT_NO_FATAL_FAILURE(boot_anew());
    }
    RunningJob running(rig(), job::make_job(chip_points(200, random_()), profile_, {}), 7);
    ASSERT_TRUE(running.run_until_fired(2 + random_() % 12));
    open_gate(rig());
    ASSERT_TRUE(run_into_a_plan(rig()));
    rig().run(up_to(ps_per_ms));
    ASSERT_TRUE(run_into_a_plan(rig()));
    lose(end, 1);
    const Picoseconds lost = rig().now();
    if (is_fault(end)) {
      rig().run(contract);
      EXPECT_EQ(rig().energy.levels(), 0u);
    } else {
      rig().run(up_to(20 * ps_per_ms));
      open_gate(rig());
      rig().press(sim::Pin::estop, rig().now() + ps_per_us, rig().now() + 5 * ps_per_ms);
      rig().run(11 * ps_per_us);
      EXPECT_EQ(rig().energy.levels(), 0u);
    }
    rig().run(60 * ps_per_ms);
    EXPECT_FALSE(rig().step_high());
    running.sender.stop();
    ASSERT_NO_FATAL_FAILURE(restart());
    EXPECT_LT(rig().last_step() - lost, 30 * ps_per_ms);
    EXPECT_THAT(rig().heard, HasSubstr(is_fault(end) ? "[MSG:Started by fault, pc 0x"
                                                     : "[MSG:Started by watchdog"));
    EXPECT_THAT(rig().heard, HasSubstr("job 7 first point not fired"));
    EXPECT_THAT(rig().status(), HasSubstr("<Alarm"));
    EXPECT_EQ(rig().answer("$X"), "[MSG:Caution: Unlocked]\r\nok\r\n");
  }
}

/// Without a plan its failure has no effect; with the next plan the watchdog restarts the chip.
TEST_F(Loss, OfTheSecondCoreAtRest) {
  lose(End::spins_deaf, 1);
  rig().run(300 * ps_per_ms);
  EXPECT_EQ(rig().board.chip().watchdog_resets(), 0u);
  RunningJob running(rig(), job::make_job(chip_points(60, random_()), profile_, {}), 1);
  const Picoseconds end = rig().now() + 500 * ps_per_ms;
  while (rig().now() < end && rig().board.chip().watchdog_resets() == 0 && running.sender.step()) {
  }
  running.sender.stop();
  ASSERT_NO_FATAL_FAILURE(restart());
  EXPECT_EQ(rig().shots().size(), 0u);
}

/// In a hold no shot is in the hardware, and the record says so.
TEST_F(Loss, InAHold) {
  RunningJob running(rig(), job::make_job(chip_points(60, random_()), profile_, {}), 1);
  ASSERT_TRUE(running.run_until_fired(8));
  rig().type("!");
  rig().run(100 * ps_per_ms);
  ASSERT_THAT(rig().status(), HasSubstr("<Hold"));
  const std::size_t shots = rig().shots().size();
  lose(End::spins_deaf);
  running.sender.stop();
  ASSERT_NO_FATAL_FAILURE(restart());
  EXPECT_EQ(rig().shots().size(), shots);
  EXPECT_THAT(rig().heard, HasSubstr(rest_message(1, shots, false)));
}

/// The position is unknown after a failure during or after a program: the next command is refused.
TEST_F(Loss, InAProgramAndAfterIt) {
  for (const bool after_it : {false, true}) {
    SCOPED_TRACE(after_it);
    boot_anew();
    rig().type("G1 X20 F6000\n");
    rig().run((after_it ? 500 : 60) * ps_per_ms);
    ASSERT_THAT(rig().status(), HasSubstr(after_it ? "<Idle" : "<Run"));
    lose(End::spins_deaf);
    ASSERT_NO_FATAL_FAILURE(restart());
    EXPECT_THAT(rig().status(), HasSubstr("<Alarm"));
    EXPECT_THAT(rig().heard, HasSubstr("Started by watchdog, programs had run]"));
  }
}

/// The record of a job takes three stores; a reset between them makes it unreadable.
TEST_F(Loss, WithARecordHalfWritten) {
  RunningJob running(rig(), job::make_job(chip_points(60, random_()), profile_, {}), 1);
  ASSERT_TRUE(running.run_until_fired(3));
  lose(End::spins_deaf);
  constexpr std::uint32_t scratch6 = 0x4005'8024;  // WATCHDOG SCRATCH6
  rig().board.chip().bus().write(scratch6, 12'345, Width::word, Master::core0,
                                 rig().core().cycle());
  running.sender.stop();
  ASSERT_NO_FATAL_FAILURE(restart());
  EXPECT_THAT(rig().status(), HasSubstr("<Alarm"));
}

/// Slices of plans must not feed the watchdog of a machine whose e-stop interrupt has failed.
TEST_F(Loss, OfTheStopInterruptWhilePlanning) {
  RunningJob running(rig(), job::make_job(chip_points(2000, random_()), profile_, {}), 1);
  ASSERT_TRUE(running.run_until_fired(5));
  // The processor itself makes a store to NVIC_ICER.
  sim::chip::Core& core = rig().core();
  for (int i = 0; i < 100'000 && core.idle(); ++i)
    rig().board.chip().run_until(rig().board.chip().now() + 20);
  const std::array<std::uint32_t, 3> saved{core.reg(0), core.reg(1), core.reg(15)};
  constexpr std::uint32_t icer = 0xe000'e180, io_irq_bank0 = 1u << 13;
  constexpr std::uint16_t store = 0x6008, loop = 0xe7fe;  // str r0, [r1]
  const bool masked = core.primask();
  core.set_primask(true);
  put(spare, store);
  put(spare + 2, loop);
  core.set_reg(0, io_irq_bank0);
  core.set_reg(1, icer);
  core.set_reg(15, spare);
  // The core may be ahead of the chip.
  for (int i = 0; i < 1000 && core.reg(15) != spare + 2; ++i)
    rig().board.chip().run_until(rig().board.chip().now() + 20);
  ASSERT_EQ(core.reg(15), spare + 2);
  core.set_reg(0, saved[0]);
  core.set_reg(1, saved[1]);
  core.set_reg(15, saved[2]);
  core.set_primask(masked);
  const Picoseconds end = rig().now() + 1100 * ps_per_ms;
  while (rig().now() < end && rig().board.chip().watchdog_resets() == 0 && running.sender.step()) {
  }
  EXPECT_EQ(rig().board.chip().watchdog_resets(), 1u);
}

/// All power and the core's power fail in turn; the chip reports both as power-on.
TEST_F(Loss, OfPowerInAJob) {
  rig().is_broken = true;  // drives lose a step when the power is cut
  for (int round = 0; round < scaled(4); ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const job::Job job = job::make_job(chip_points(60, random_()), profile_, {});
    RunningJob running(rig(), job, static_cast<std::uint32_t>(round + 1));
    ASSERT_TRUE(running.run_until_fired(2 + random_() % 12));
    open_gate(rig());
    rig().run(ps_per_ms + up_to(2 * ps_per_ms));
    const Picoseconds cut = rig().now();
    if (round % 2 == 0)
      rig().board.power_cut();
    else
      rig().board.chip().brown_out();
    EXPECT_EQ(rig().energy.levels(), 0u);
    EXPECT_FALSE(rig().step_high());
    rig().heard.clear();
    rig().boot();
    EXPECT_THAT(rig().heard, HasSubstr("[MSG:Started by power on]"));
    rig().run(30 * ps_per_ms);
    EXPECT_FALSE(rig().energy.any_high_within(cut, rig().now()));
    EXPECT_FALSE(rig().monitor.stepped(cut, rig().now()));
    EXPECT_EQ(rig().board.stored_settings(), profile_.settings);
    EXPECT_THAT(rig().status(), HasSubstr("<Idle"));
  }
}

}  // namespace
}  // namespace lamplock::test::hang_test
