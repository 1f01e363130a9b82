// The simulated RP2040 with our image against wall-clock time: idle on USB, and engraving. Goal:
// real time, 125 million cycles per second.
#include <benchmark/benchmark.h>

#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "sim/chip_board/chip_board.hpp"
#include "tests/flash_image_path.hpp"
#include "tests/step_histogram.hpp"

namespace lamplock {
namespace {

constexpr double lamp_hz = 100, accel_m_s2 = 2;

job::Profile profile() {
  job::Profile result = job::default_profile();
  job::set_lamp_hz(result, lamp_hz);
  job::set_acceleration(result, accel_m_s2);
  return result;
}

/// Counts a board's cycles and simulated time while the benchmark's clock runs.
class Meter {
 public:
  void start(sim::ChipBoard& board) {
    from_ = board.now();
    first_ = board.chip().now();
  }
  void stop(sim::ChipBoard& board) {
    simulated_s_ += sim::seconds(board.now() - from_);
    cycles_ += static_cast<double>(board.chip().now() - first_);
  }
  void report(benchmark::State& state) const {
    state.counters["x_real_time"] = benchmark::Counter(simulated_s_, benchmark::Counter::kIsRate);
    state.counters["Mcycles"] = benchmark::Counter(cycles_ / 1e6, benchmark::Counter::kIsRate);
  }

 private:
  sim::Picoseconds from_ = 0;
  sim::chip::Cycle first_ = 0;
  double simulated_s_ = 0, cycles_ = 0;
};

/// Runs `what` on boards that a host has just detected.
template <typename What>
void on_board(benchmark::State& state, What what) {
  const sim::chip::Image image = sim::chip::load_image(test::flash_image_path());
  Meter meter;
  for (auto _ : state) {
    state.PauseTiming();
    sim::WorldConfig world;
    world.lamp.frequency_hz = lamp_hz;
    sim::ChipBoard board(image, profile().settings, world);
    if (!board.run_until_found(sim::ps_per_s)) {
      state.SkipWithError("the host has not found the board");
      break;
    }
    meter.start(board);
    state.ResumeTiming();
    what(board);
    state.PauseTiming();
    meter.stop(board);
    state.ResumeTiming();
  }
  meter.report(state);
}

void chip_idle(benchmark::State& state) {
  on_board(state, [](sim::ChipBoard& board) { board.run_until(board.now() + sim::ps_per_s / 2); });
}
BENCHMARK(chip_idle)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void chip_job(benchmark::State& state) {
  constexpr std::size_t points = 100;
  const job::Job job = job::make_job(test::histogram_walk(points, 1), profile(), {});
  on_board(state, [&](sim::ChipBoard& board) {
    link::SimulatedTransport transport(board);
    link::JobSender sender(transport, job);
    const sim::Picoseconds limit =
        board.now() + 10 * sim::ps_per_s;  // about ten times the needed time
    while (sender.step() && board.now() < limit) continue;
    const link::JobResult result = sender.result();
    if (result.status.shots != job.targets.size()) state.SkipWithError("points were not fired");
  });
}
BENCHMARK(chip_job)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace lamplock
