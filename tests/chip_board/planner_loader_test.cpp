// Planners that take turns in the same memory of the chip: lines of a program, path, start-stop and
// free points, with holds, resets and e-stops at random moments, also while a planner is copied.
// What is not interrupted makes the same steps as on the virtual board, points at the same ticks. A
// wrong copy never runs.
#include <fmt/format.h>

#include "sim/virtual_board/virtual_board.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test::planner_loader_test {
namespace {

using sim::chip::Master;
using sim::chip::Width;

constexpr std::array<const char*, 4> kinds{"free", "path", "start-stop", "lines"};
constexpr std::size_t lines_kind = 3;
constexpr std::array<JoinMode, 3> modes{JoinMode::free, JoinMode::path, JoinMode::start_stop};
constexpr std::uint8_t undefined = 0xde;  // half of the instruction UDF #0xde

std::uint32_t address(const char* symbol) {
  const sim::chip::ImageSymbol* found = flash_image().find(symbol);
  if (found == nullptr) throw std::runtime_error(std::string(symbol) + ": not in the image");
  return found->address;
}

/// The memory of the planners and their places in flash, from the linker script.
struct Places {
  std::uint32_t memory = address("planner_memory"), end = address("planner_memory_end");
  std::uint32_t lines = address("planner_lines_in_flash"), path = address("planner_path_in_flash");
  std::uint32_t free = address("planner_free_in_flash"), image = address("image_in_flash");

  /// Begin and end in flash of what a kind of work needs.
  std::pair<std::uint32_t, std::uint32_t> planner(std::size_t kind) const {
    if (kind == lines_kind) return {lines, path};
    return modes[kind] == JoinMode::path ? std::pair{path, free} : std::pair{free, image};
  }
};

std::vector<std::uint8_t> read(ChipRig& rig, std::uint32_t from, std::uint32_t to) {
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t at = from; at < to; ++at)
    bytes.push_back(static_cast<std::uint8_t>(
        rig.board.chip().bus().read(at, Width::byte, Master::dma, rig.board.chip().now()).value));
  return bytes;
}

/// The memory holds the planner of this kind, and undefined instructions after it.
void expect_loaded(ChipRig& rig, std::size_t kind) {
  const Places places;
  const auto [begin, end] = places.planner(kind);
  const std::span<const std::uint8_t> flash = rig.board.chip().flash().storage();
  const auto code = flash.subspan(begin - 0x1000'0000, end - begin);
  std::vector<std::uint8_t> wanted(code.begin(), code.end());
  wanted.resize(places.end - places.memory, undefined);
  EXPECT_EQ(read(rig, places.memory, places.end), wanted) << kinds[kind];
}

/// Short moves for one planner: a job or a program, from where the machine is.
struct Item {
  std::size_t kind = 0;
  job::Job job;
  std::string text;
};

/// Steps of the three axes since the last call, by ticks since the first of them.
class StepsSince {
 public:
  explicit StepsSince(const PinMonitor& monitor) : monitor_(monitor) {}
  std::vector<Step> take() {
    std::vector<Step> steps;
    Picoseconds first = sim::never;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& all = monitor_.steps(axis);
      if (taken_[index(axis)] < all.size()) first = std::min(first, all[taken_[index(axis)]].at);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto& all = monitor_.steps(axis);
      for (std::size_t& i = taken_[index(axis)]; i < all.size(); ++i)
        steps.emplace_back(axis, (all[i].at - first + ps_per_tick / 2) / ps_per_tick,
                           all[i].position);
    }
    return steps;
  }

 private:
  const PinMonitor& monitor_;
  PerAxis<std::size_t> taken_{};
};

class PlannersInTurn : public BootedRig, public testing::WithParamInterface<std::uint64_t> {
 protected:
  PlannersInTurn() : BootedRig(GetParam()), board_(profile_.settings, world_for(profile_)) {
    board_.run_until(ps_per_ms);
  }

  Item make_item(std::size_t kind) {
    Item item{kind, {}, {}};
    // Around the middle of the work space, so that no walk leaves it.
    const geometry::PointCloud cloud = chip_points(6 + random_() % 10, random_());
    if (kind == lines_kind) {
      // The first line is long: meanwhile both boards receive the others.
      side_ = -side_;
      item.text = "G21 G90 G1 F6000\n";
      for (const geometry::Point& p : cloud)
        item.text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", p.x + 1.5 * side_, p.y, p.z);
      return item;
    }
    job::JobOptions options;
    options.mode = modes[kind];
    item.job = job::make_job(cloud, profile_, options);
    return item;
  }
  /// Runs the item to its end on one board.
  void run(sim::Board& board, ProgramSender& user, const Item& item) {
    if (item.kind == lines_kind) {
      user.give(item.text);
      const Picoseconds end = board.now() + 10 * ps_per_s;
      ASSERT_TRUE(user.run_until_answered(end) && user.run_until_idle(end));
      end_program(user);
    } else {
      link::SimulatedTransport transport(board);
      link::JobSender sender(transport, item.job, RunningJob::options(++session_, 0));
      ASSERT_EQ(sender.run().end, JobEnd::done);
    }
    board.run_until(board.now() + 5 * ps_per_ms);
  }
  void run_on_both(const Item& item) {
    const std::size_t chips = rig().shots().size();
    const std::size_t ours = board_.world().laser().shots().size();
    chips_steps_.take();
    our_steps_.take();
    ASSERT_NO_FATAL_FAILURE(run(rig().board, rig().user, item));
    ASSERT_NO_FATAL_FAILURE(run(board_, user_, item));
    expect_loaded(rig(), item.kind);
    std::vector<Step> wanted = our_steps_.take(), made = chips_steps_.take();
    EXPECT_FALSE(wanted.empty());
    // Lines are not tied to the beats of the lamp, which sets the lengths of ticks: ticks_test.cpp
    // compares their times without a lamp.
    if (item.kind == lines_kind) {
      for (Step& step : wanted) std::get<1>(step) = 0;
      for (Step& step : made) std::get<1>(step) = 0;
    }
    EXPECT_EQ(made, wanted);
    EXPECT_EQ(rig().shots().size() - chips, item.job.targets.size());
    for (std::size_t i = 0; i < item.job.targets.size(); ++i) {
      const sim::Shot &shot = rig().shots()[chips + i],
                      &other = board_.world().laser().shots()[ours + i];
      EXPECT_EQ(shot.beat - rig().shots()[chips].beat,
                other.beat - board_.world().laser().shots()[ours].beat);
    }
  }
  /// Begins the item on the chip alone and breaks it off: hold and reset, reset alone, e-stop.
  void interrupt(const Item& item, int how) {
    // The copy takes some 4 ms; a job, its link included, some 60 ms.
    const Picoseconds moment =
        rig().now() + up_to(random_() % 2 == 0 ? 8 * ps_per_ms : 60 * ps_per_ms);
    const std::size_t fired = rig().shots().size();
    if (item.kind == lines_kind) {
      rig().user.send(item.text);
      break_off(moment, how);
    } else {
      RunningJob running(rig(), item.job, ++session_);
      running.run_until(moment);
      break_off(moment, how);
      running.sender.stop();
      try {
        running.finish();
      } catch (const Error& refused) {
        // The e-stop came before the job had begun.
        EXPECT_EQ(how, 2);
        EXPECT_THAT(refused.what(), HasSubstr("unlock it with $X"));
        EXPECT_EQ(rig().shots().size(), fired);
      }
      expect_fired_so_far(rig(), item.job, fired);
    }
    rig().run(80 * ps_per_ms);
    rig().type("\x18");
    rig().run(20 * ps_per_ms);
    rig().listen();
    if (rig().status().find("<Alarm") != std::string::npos) {
      EXPECT_THAT(rig().answer("$X"), HasSubstr("ok"));
    }
    // Edges during an e-stop have no time stamps but the times of their interrupts: until some
    // beats later the lengths of ticks differ by some 10^-5 from those of the virtual board.
    rig().run(300 * ps_per_ms);
  }
  void break_off(Picoseconds moment, int how) {
    if (rig().now() < moment) rig().board.run_until(moment);
    if (how == 2) {
      rig().press(sim::Pin::estop, rig().now() + ps_per_us, rig().now() + 5 * ps_per_ms);
    } else {
      rig().type(how == 0 ? "!" : "\x18");
    }
    rig().run(up_to(30 * ps_per_ms));
  }
  /// Moves the chip's machine to where that of the virtual board is.
  void meet() {
    std::string line = "G21 G90 G0";
    for (int axis = 0; axis < 3; ++axis)
      line += fmt::format(" {}{:.3f}", "XYZ"[axis],
                          board_.world().drives().position()[index(axis)] * 1000.0 /
                              profile_.settings.milli(Id::steps_per_mm_x, axis));
    EXPECT_THAT(rig().answer(line), HasSubstr("ok"));
    ASSERT_TRUE(rig().user.run_until_idle(rig().now() + 5 * ps_per_s));
    rig().run(5 * ps_per_ms);
    EXPECT_EQ(rig().board.world().drives().position(), board_.world().drives().position());
    end_program(rig().user);
  }
  /// Lines end beside the middle of their last step, and other lines would begin there.
  static void end_program(ProgramSender& user) {
    user.send("\x18");
    user.run(20 * ps_per_ms);
  }

  sim::VirtualBoard board_;
  const PinMonitor monitor_{board_.bus(), board_.world().lamp()};
  ProgramSender user_{board_};
  StepsSince our_steps_{monitor_};
  StepsSince chips_steps_{rig().monitor};
  std::uint32_t session_ = 0;
  int side_ = 1;
};

TEST_P(PlannersInTurn, MakeTheStepsOfTheVirtualBoard) {
  std::size_t kind = 0;
  // All four together: 1000 in a complete run, eight every day; each takes a third of a second.
  const int rounds = is_complete_run() ? 250 : scaled(3, 2);
  for (int round = 0; round < rounds && !HasFailure(); ++round) {
    kind = (kind + 1 + random_() % (kinds.size() - 1)) % kinds.size();  // always another one
    SCOPED_TRACE(fmt::format("round {}: {}", round, kinds[kind]));
    const Item item = make_item(kind);
    if (round % 2 == 0) {
      ASSERT_NO_FATAL_FAILURE(interrupt(item, static_cast<int>(random_() % 3)));
      ASSERT_NO_FATAL_FAILURE(meet());
    } else {
      ASSERT_NO_FATAL_FAILURE(run_on_both(item));
    }
  }
  EXPECT_EQ(rig().board.chip().watchdog_resets(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PlannersInTurn, testing::Values(27, 28, 29, 30));

/// A rig and a look at the memory of its planners.
class PlannerLoader : public testing::Test {
 protected:
  static constexpr std::uint32_t two_undefined = 0xdede'dede;

  std::uint32_t word(std::uint32_t at) {
    return rig_.board.chip()
        .bus()
        .read(at, Width::word, Master::dma, rig_.board.chip().now())
        .value;
  }
  void flip_a_bit(std::uint32_t at) {
    rig_.board.chip().bus().write(at, word(at) ^ 0x10, Width::word, Master::dma,
                                  rig_.board.chip().now());
  }
  /// The first pieces of a planner of this size are copied, but not its end.
  bool in_a_copy(std::uint32_t bytes) {
    return word(places_.memory + 4096) != two_undefined &&
           word(places_.memory + bytes - 4) == two_undefined;
  }
  bool second_core_inside() {
    const std::uint32_t pc = rig_.board.chip().core(1).reg(15);
    return pc >= places_.memory && pc < places_.end;
  }
  /// Calls `look` every 20 us of the next 400 ms while the job runs.
  void watch(RunningJob& running, const std::function<void()>& look) {
    for (int i = 1; i < 20'000; ++i) running.cable.at(rig_.now() + i * 20 * ps_per_us, look);
  }

  ChipRig rig_;
  const Places places_;
};

/// From the line to the first step: core 1 does not run in the memory of the planners before the
/// copy is complete.
TEST_F(PlannerLoader, TheSecondCoreWaitsForTheCopy) {
  const std::uint32_t size = places_.path - places_.lines;
  EXPECT_EQ(word(places_.memory), two_undefined) << "nothing is loaded at the start";
  rig_.user.send("G91 G0 X1\n");
  int copying = 0, inside = 0;
  while (rig_.last_step() == 0 && rig_.now() < ps_per_s) {
    rig_.run(2 * ps_per_us);
    const bool complete = word(places_.memory + size - 4) != two_undefined;
    copying += in_a_copy(size) ? 1 : 0;
    inside += second_core_inside() ? 1 : 0;
    ASSERT_TRUE(complete || !second_core_inside()) << "at " << sim::seconds(rig_.now());
  }
  EXPECT_GT(copying, 100);
  EXPECT_GT(inside, 0);
}

/// A bit flips in two copies before they are checked: the planner is copied again, and the job
/// runs.
TEST_F(PlannerLoader, ADisturbedCopyIsRepeated) {
  const job::Job job = job::make_job(chip_points(20, 3), chip_profile(), {});
  RunningJob running(rig_, job, 1);
  int disturbed = 0;
  bool another = true;
  watch(running, [&] {
    if (!in_a_copy(places_.image - places_.free)) {
      another = true;
    } else if (another && disturbed < 2) {
      another = false;
      ++disturbed;
      flip_a_bit(places_.memory + 100);  // of the first piece, which is complete
    }
  });
  EXPECT_EQ(running.finish(), JobEnd::done);
  EXPECT_EQ(disturbed, 2);
  expect_fired(rig_, job);
  expect_loaded(rig_, 0);
  EXPECT_EQ(rig_.board.chip().watchdog_resets(), 0u);
}

/// The flash has lost a bit since the start: the planner never runs. The board restarts, and its
/// loader refuses the image: the loader of the ROM runs, and all outputs are off.
TEST_F(PlannerLoader, AWrongPlannerInFlashNeverRuns) {
  constexpr std::uint32_t rom_end = 0x1000'0000;
  rig_.is_broken = true;  // the board leaves the bus in the middle of a job
  rig_.board.chip().flash().storage()[places_.path + 1000 - 0x1000'0000] ^= 4;
  job::JobOptions options;
  options.mode = JoinMode::path;
  RunningJob running(rig_, job::make_job(chip_points(20, 3), chip_profile(), options), 1);
  int copying = 0, inside = 0;
  watch(running, [&] {
    copying += in_a_copy(places_.free - places_.path) ? 1 : 0;
    inside += second_core_inside() && rig_.core().reg(15) >= rom_end ? 1 : 0;
  });
  const Picoseconds end = rig_.now() + 300 * ps_per_ms;
  while (rig_.now() < end && running.sender.step()) {
  }
  if (rig_.now() < end) running.cable.run_until(end);
  EXPECT_GT(copying, 10);
  EXPECT_EQ(inside, 0);
  EXPECT_LT(rig_.core().reg(15), rom_end);
  EXPECT_TRUE(rig_.shots().empty());
  EXPECT_EQ(rig_.last_step(), 0);
  EXPECT_EQ(rig_.energy.levels(), 0u);
}

}  // namespace
}  // namespace lamplock::test::planner_loader_test
