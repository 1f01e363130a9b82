// A machine with switches, a probe and a laser, and what hosts do with it: lines, frames, jobs of
// points and of rows, bytes and doors at any moment.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "host/error.hpp"
#include "tests/board/board_cable.hpp"
#include "tests/board/machine_with_switches.hpp"
#include "tests/board/pixel_rows.hpp"

namespace lamplock::test {

inline constexpr std::uint8_t reset_byte = 0x18, door_byte = 0x84, jog_cancel_byte = 0x85;

/// At 50 mm/s at most, braking at 2 m/s2.
inline job::Profile bench_profile(bool parking) {
  job::Profile profile = homing_profile();
  settings::Values& s = profile.settings;
  s.set_milli(Id::laser_mode, 1000);
  s.set_milli(Id::homing_seek, 3'000'000);
  for (int a = 0; a < 3; ++a) s.set_milli(settings::for_axis(Id::max_rate_x, a), 3'000'000);
  if (parking) {
    s.set_milli(Id::parking, 1000);
    s.set_milli(Id::parking_slow, 600'000);
    s.set_milli(Id::parking_fast, 3'000'000);
    s.set_milli(Id::parking_target, 40'000);
  }
  return profile;
}

inline sim::WireConfig probe_at(std::int32_t step) {
  return {.pin = sim::Pin::probe,
          .contacts = {sim::ContactConfig::above(0, step, 20)},
          .normally_closed = false};
}

inline link::SenderOptions of_session(std::uint32_t session) {
  link::SenderOptions options;
  options.session = session;
  return options;
}

/// A machine during an activity, with the host of a job if the activity has one.
struct Bench {
  explicit Bench(bool parking, bool after_a_job = true)
      : profile(bench_profile(parking)), machine(profile, {}, {probe_at(9'000)}) {
    machine.host.ask("$X\n");
    machine.host.run_ms(
        0.5);  // the table of docs/safety.md was measured at this phase of the board
    if (!after_a_job) return;
    // COMMAND frames need a session; this job opens one.
    job::JobOptions dry;
    dry.dry = true;
    run_job(machine.rig, job::make_job({{0, 0, 0}}, profile, dry), of_session(session));
  }
  sim::VirtualBoard& board() { return machine.rig.board; }
  sim::Picoseconds now() { return board().now(); }
  void pass(sim::Picoseconds time) {
    const sim::Picoseconds end = now() + time;
    if (!host_step) return machine.host.run(time);
    while (now() < end && host_step) work_host();
    if (now() < end) machine.rig.run(end - now());
  }
  /// A host whose job another stop has ended throws.
  void work_host() {
    try {
      if (!host_step()) host_step = nullptr;
    } catch (const Error&) {
      host_step = nullptr;
    }
  }
  void type(std::string_view lines) { machine.host.send(lines); }
  void command(wire::Command command) {
    constexpr std::uint32_t later_than_all = 1'000'000;
    std::array<std::uint8_t, wire::frame_header_size + 1> content;
    wire::ByteWriter out(content);
    wire::write_header(out, {wire::FrameType::command, session, later_than_all});
    out.put(static_cast<std::uint8_t>(command));
    std::array<std::uint8_t, wire::max_frame> frame;
    board().write(std::span(frame).first(wire::encode_frame(out.written(), frame)));
  }
  void set(sim::Pin pin, bool level) { board().world().schedule(pin, level, now()); }
  void door(bool open) { set(sim::Pin::door, open); }

  job::Profile profile;
  MachineWithSwitches machine;
  std::uint32_t session = 5;
  std::function<bool()> host_step{};  ///< one step of the job's host
  std::shared_ptr<void> host{};
};

inline void begin_points(Bench& bench) {
  struct Host {
    explicit Host(Bench& bench)
        : cable(bench.machine.rig),
          job(job::make_job(histogram_walk(400, 3), bench.profile, {})),
          sender(cable, job, of_session(6)) {}
    BoardCable cable;
    job::Job job;
    link::JobSender sender;
  };
  auto host = std::make_shared<Host>(bench);
  bench.session = 6;
  bench.host_step = [host = host.get()] { return host->sender.step(); };
  bench.host = host;
}

inline void begin_rows(Bench& bench) {
  struct Host {
    explicit Host(Bench& bench)
        : raster(1, 6, 300, 1),
          lines(PixelLines(raster).lines()),
          cable(bench.machine.rig),
          rows(cable, lines, header(bench.profile)) {}
    static wire::JobHeader header(const job::Profile& profile) {
      wire::JobHeader header;
      header.axes = static_cast<std::uint8_t>(profile.settings.whole(Id::axes));
      return header;
    }
    Raster raster;
    std::vector<PixelLine> lines;
    BoardCable cable;
    RowHost rows;
  };
  auto host = std::make_shared<Host>(bench);
  host->rows.do_not_resume();
  bench.session = 77;
  bench.host_step = [host = host.get()] {
    host->rows.step();
    return true;
  };
  bench.host = host;
}

}  // namespace lamplock::test
