// The virtual board against wall-clock time: the measured object of 16 179 points at 100 Hz and 2
// m/s2, sent over the link. Goal: 300 times real time without traces, ideally 1000.
#include <benchmark/benchmark.h>

#include <optional>
#include <ostream>
#include <streambuf>

#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "sim/trace/vcd.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/step_histogram.hpp"

namespace lamplock {
namespace {

/// Counts the characters written to it.
class CountingBuffer final : public std::streambuf {
 public:
  double bytes() const { return bytes_; }

 private:
  int overflow(int c) override {
    ++bytes_;
    return c;
  }
  std::streamsize xsputn(const char* /*text*/, std::streamsize size) override {
    bytes_ += static_cast<double>(size);
    return size;
  }
  double bytes_ = 0;
};

enum class Trace { none, vcd };

void board(benchmark::State& state, wire::JoinMode mode, Trace trace) {
  constexpr double lamp_hz = 100, accel_m_s2 = 2;
  job::Profile profile = job::default_profile();
  job::set_lamp_hz(profile, lamp_hz);
  job::set_acceleration(profile, accel_m_s2);
  job::JobOptions options;
  options.mode = mode;
  const job::Job job = job::make_job(
      test::histogram_walk(static_cast<std::size_t>(bench::glass_points), 1), profile, options);
  double simulated_s = 0, beats = 0, vcd_bytes = 0;
  // NOLINTNEXTLINE(clang-analyzer-deadcode.DeadStores): the library requires this loop
  for (auto _ : state) {
    sim::WorldConfig world;
    world.lamp.frequency_hz = lamp_hz;
    sim::VirtualBoard virtual_board(profile.settings, world);
    CountingBuffer buffer;
    std::ostream out(&buffer);
    std::optional<sim::VcdWriter> vcd;
    if (trace == Trace::vcd) vcd.emplace(out, virtual_board.bus());
    link::SimulatedTransport transport(virtual_board);
    const link::JobResult result = link::JobSender(transport, job).run();
    if (vcd) vcd->finish(virtual_board.now());
    if (result.status.shots != job.targets.size()) state.SkipWithError("points were not fired");
    simulated_s += sim::seconds(virtual_board.now());
    beats = result.status.beats;
    vcd_bytes = buffer.bytes();
  }
  state.counters["x_real_time"] = benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
  state.counters["beats_per_point"] = beats / static_cast<double>(job.targets.size());
  if (trace == Trace::vcd) state.counters["vcd_MB"] = vcd_bytes / 1e6;
}
BENCHMARK_CAPTURE(board, free, wire::JoinMode::free, Trace::none)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(board, start_stop, wire::JoinMode::start_stop, Trace::none)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(board, free_vcd, wire::JoinMode::free, Trace::vcd)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(board, start_stop_vcd, wire::JoinMode::start_stop, Trace::vcd)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
