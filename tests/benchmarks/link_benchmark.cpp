// Throughput of the flash image's link, over the serial port and over the pulse stream: bytes of
// frames that the firmware has parsed, and points of a job at a 4 kHz lamp. Numbers of the table in
// docs/testing.md, in simulated time.
#include <benchmark/benchmark.h>

#include <array>

#include "host/link/connection.hpp"
#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "sim/chip_board/chip_board.hpp"
#include "sim/world/drive_settings.hpp"
#include "tests/flash_image_path.hpp"

namespace lamplock {
namespace {

using sim::chip::UsbFunction;

job::Profile profile() {
  job::Profile result = job::default_profile();
  job::set_lamp_hz(result, 4000);
  job::set_acceleration(result, 10);
  job::set_speed(result, 1);
  return result;
}

/// A board that a host has just detected, with the USB function of the benchmark's argument.
struct Desk {
  explicit Desk(const benchmark::State& state)
      : image(sim::chip::load_image(test::flash_image_path())) {
    sim::WorldConfig world;
    world.lamp.frequency_hz = 4000;
    world.drives = sim::drives_of(profile().settings);
    board.emplace(image, profile().settings, world);
    found = board->run_until_found(sim::ps_per_s);
    board->talk_over(static_cast<UsbFunction>(state.range(0)));
  }
  sim::chip::Image image;
  std::optional<sim::ChipBoard> board;
  bool found = false;
};

/// Repeats a QUERY until its STATUS arrives and returns it; an empty one after a second.
wire::Status ask(sim::ChipBoard& board, link::Connection& connection, std::uint32_t tag) {
  wire::Status last;
  for (int i = 0; i < 1000 && last.echo != tag; ++i) {
    if (i % 20 == 0) connection.send_query(0, tag);
    connection.flush();
    board.run_until(board.now() + sim::ps_per_ms);
    while (const auto message = connection.receive())
      if (const auto* status = std::get_if<wire::Status>(&*message)) last = *status;
  }
  return last;
}

/// DATA frames of a job that has not begun: parsed whole, checked, counted and refused. As a sender
/// does, it never has more frames under way than the board holds.
void link_bytes(benchmark::State& state) {
  constexpr std::size_t payload_size = 400;
  // Type, session, number, CRC, STX and ETX; zeros need no escape.
  constexpr std::size_t frame_size = payload_size + wire::frame_header_size + wire::crc_size + 2;
  constexpr std::uint32_t window = 3000 / frame_size;
  constexpr sim::Picoseconds span = sim::ps_per_s / 4;
  const std::array<std::uint8_t, payload_size> payload{};
  double rate = 0, lost = 0;
  for (auto _ : state) {
    Desk desk(state);
    sim::ChipBoard& board = *desk.board;
    link::SimulatedTransport transport(board);
    link::Connection connection(transport);
    std::uint32_t sent = ask(board, connection, 1).link.out_of_order, taken = sent;
    const std::uint32_t before = taken;
    const sim::Picoseconds start = board.now();
    while (desk.found && board.now() < start + span) {
      for (; sent - taken < window; ++sent) connection.send({wire::FrameType::data, 7, 1}, payload);
      connection.flush();
      board.run_until(board.now() + sim::ps_per_ms / 20);
      while (const auto message = connection.receive())
        if (const auto* status = std::get_if<wire::Status>(&*message))
          taken = status->link.out_of_order;
    }
    rate = (taken - before) * static_cast<double>(frame_size) / sim::seconds(board.now() - start);
    lost = sent - ask(board, connection, 2).link.out_of_order;
  }
  state.counters["bytes_per_s"] = rate;
  state.counters["frames_lost"] = lost;
}
BENCHMARK(link_bytes)->Arg(0)->Arg(1)->Iterations(1)->Unit(benchmark::kMillisecond);

/// A row of points on every beat.
void link_points(benchmark::State& state) {
  geometry::PointCloud row;
  for (int i = 0; i < 1400; ++i) row.push_back({-28 + 0.04 * i, 0, 0});
  const job::Job job = job::make_job(row, profile(), {});
  double rate = 0;
  for (auto _ : state) {
    Desk desk(state);
    link::SimulatedTransport transport(*desk.board);
    link::SenderOptions options;
    options.session = link::simulated_session;
    const link::JobResult result = link::JobSender(transport, job, options).run();
    const sim::Shots& shots = desk.board->world().laser().shots();
    if (result.end != link::JobEnd::done || shots.size() != job.targets.size())
      state.SkipWithError("points were not fired");
    else
      rate = static_cast<double>(shots.size() - 1) / sim::seconds(shots.back().at - shots[0].at);
  }
  state.counters["points_per_s"] = rate;
}
BENCHMARK(link_points)->Arg(0)->Arg(1)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
