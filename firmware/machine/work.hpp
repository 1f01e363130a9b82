// The activities of the machine: jobs in frames, programs, jogs, homing, probes; what is watched
// while they run.
//
// In:  frames and lines that were decoded, the present settings, the time, the lamp.
// Out: points and lines for the runners; events of the machine.
// Who: the console and the controller, main loop, unmasked unless said otherwise.
#pragma once

#include <span>

#include "firmware/machine/events.hpp"
#include "shared/result.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::machine {

class MachineWork : public MachineEvents {
 public:
  /// The lamp changes its frequency during a job: the machine brakes to rest, follows the new beat
  /// and continues with the first point not fired; the frequency is dropped at the end of the job.
  /// Errors: no_job; locked; bad_value, with the number of the conflicting setting in
  /// refused_value(): then nothing has changed.
  [[gnu::cold]] Result change_beat(std::uint32_t milli_hz);

 protected:
  using MachineEvents::MachineEvents;

  // Jobs in frames (work_jobs.cpp, work_rows.cpp).
  Result on_begin(const wire::JobHeader& header);
  Result on_data(std::span<const std::uint8_t> records);
  [[gnu::cold]] Result on_end(std::uint32_t total);
  [[gnu::cold]] Result on_command(const wire::CommandRequest& request);
  bool fires_without_edges(const wire::JobHeader& header, const settings::Values& values) const;
  Result check_settings(const settings::Values& values, std::uint16_t& setting) const;
  lamp::ShotRules shot_rules(const settings::Values& values) const;

  // Programs and jogs (work_program.cpp).
  /// Bytes of the host are missing; lost frames are repeated.
  [[gnu::cold]] void lose_lines();
  GcodeError begin_program_line(std::string_view line);
  GcodeError begin_jog(std::string_view line);
  bool change_over(program::BeatLock lock);
  void configure_reader();

  // Homing (work_homing.cpp).
  GcodeError begin_homing(std::string_view axes);
  void work_homing();

  // What a program waits for (work_waits.cpp).
  bool work_probe();
  bool work_input_wait();
  [[gnu::cold]] void pause();
  [[gnu::cold]] void return_from_tool_change();
  void work_parking();
  void report_offsets(int first, int end);

  // Watched in each round, masked (work_watches.cpp).
  bool ready_to_move() const;
  void follow_new_beat();
  void hold_after_failed_shots();
  void check_dead_man();
  void check_lamp();
  /// The loop that holds a temperature ($1061); each round while it is on.
  [[gnu::cold]] void follow_temperature();
  [[gnu::cold]] void reject_unreachable();
  [[gnu::cold]] void lose_host();

  bool host_present_ = true;      ///< from the board
  bool no_lamp_said_ = false;     ///< the host has got the message that the lamp is missing
  bool lamp_was_locked_ = false;  ///< at the last prepare()
  std::uint32_t points_total_ = 0;
  std::uint32_t refused_value_ = 0;
  std::uint64_t last_byte_ = 0;      ///< clock of the last prepare() after a byte of any kind
  std::uint64_t last_jog_ = 0;       ///< the same after a line $J
  std::uint64_t no_lamp_since_ = 0;  ///< clock since which a job waits for the lamp

 private:
  Result may_begin_job() const;
  Result begin_job(const wire::JobHeader& header);
  Result job_settings(const wire::JobHeader& header, settings::Values& values);
  Result begin_rows(const wire::JobHeader& header, const settings::Values& values,
                    std::uint32_t tick_q16);
  Result take_rows(std::span<const std::uint8_t> records);
  Result end_rows(std::uint32_t total);
  Result set_speed_of_rows(std::uint32_t percent);
  bool start_program();
  void find_position();
  bool begin_lines(const settings::Values& values);
  void begin_points(program::BeatLock lock);
  void go_homing();
  void fail_homing(std::uint8_t alarm);
  void end_homing();
  void begin_probe();
  bool end_probe();
  void report_tool();
  [[gnu::cold]] void hold_without_host();
  [[gnu::cold]] void miss_lamp();
};

}  // namespace lamplock::machine
