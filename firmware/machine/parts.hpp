// The parts of the machine, the settings in force, and what follows from them.
//
// The core is one object in five layers, each a class that extends the one before it and calls no
// later one:
//
//   MachineParts    parts.hpp       all parts and settings; answers to the host
//   MachineEvents   events.hpp      events of the machine (machine.hpp) and their effects
//   MachineWork     work.hpp        jobs, programs, jogs, homing; what is watched meanwhile
//   MachineConsole  console.hpp     lines, commands, real-time bytes, reports
//   Controller      controller.hpp  the calls of the board
//
// Who: all layers run in the main loop; controller.hpp says what interrupts call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/lamp/shot_scheduler.hpp"
#include "firmware/link/link.hpp"
#include "firmware/machine/activities/homing.hpp"
#include "firmware/machine/activities/parking.hpp"
#include "firmware/machine/activities/program_reader.hpp"
#include "firmware/machine/activities/row_job.hpp"
#include "firmware/machine/board_types.hpp"
#include "firmware/machine/console/program_text.hpp"
#include "firmware/machine/console/status_report.hpp"
#include "firmware/machine/inputs/input_wait.hpp"
#include "firmware/machine/inputs/inputs.hpp"
#include "firmware/machine/inputs/move_guard.hpp"
#include "firmware/machine/inputs/temperature_loop.hpp"
#include "firmware/machine/interrupt_mask.hpp"
#include "firmware/machine/machine.hpp"
#include "firmware/machine/outputs/idle_release.hpp"
#include "firmware/machine/outputs/program_outputs.hpp"
#include "firmware/machine/runners/job_runner.hpp"
#include "firmware/machine/runners/program_runner.hpp"
#include "firmware/program/pulse_decoder.hpp"
#include "shared/gcode_errors.hpp"
#include "shared/settings_table.hpp"
#include "shared/text_line.hpp"
#include "shared/work_space.hpp"

namespace lamplock::machine {

/// Until when lines of programs are refused.
enum class Refusal : std::uint8_t {
  none,
  until_unlocked,  ///< after an error ($981): to the next `$X` or reset
  until_reset      ///< lines were lost
};

class MachineParts {
 public:
  MachineParts(const MachineParts&) = delete;
  MachineParts& operator=(const MachineParts&) = delete;

 protected:
  /// Room reserved for answers: without it lines wait.
  static constexpr std::size_t answer_room = 128;
  /// Lines leave this much in addition, so that a host that reads no answers still gets one status.
  static constexpr std::size_t status_room = TextLine::capacity;
  static constexpr std::string_view unlock_text = "'$H'|'$X' to unlock";

  [[gnu::cold]] MachineParts(const settings::Values& stored, const InterruptMask& mask,
                             const BoardFeatures& board)
      : mask_(mask),
        board_(board),
        stored_(stored),
        values_(stored),
        planning_(board.loads_planners),
        runner_(clock_, shots_, motion_, planning_, board.parts),
        drives_(board.second_wire) {}

  // Settings in force (parts.cpp).
  [[gnu::cold]] bool use_kinematics();
  [[gnu::cold]] void use_settings(const settings::Values& values);
  void end_overrides();
  [[gnu::cold]] void set_trigger();
  FireTiming fire_timing() const;

  // Answers to the host (parts_replies.cpp).
  /// Sends "[MSG:text]" to the host.
  void report_message(std::string_view text);
  void answer(GcodeError error);
  void send_banner();
  void greet();
  [[gnu::cold]] void report_tool_length();

  // What follows from the state of the parts (parts_at_rest.cpp).
  bool door_open() const { return (inputs_ & set_of(Input::door)) != 0; }
  bool drives_may_be_on() const { return !machine_.in(states(State::estop, State::sleep)); }
  bool drives_may_rest() const;
  /// The laser of a program, in motion and while it stops; a door ends it at once.
  bool laser_may_shine() const {
    return program_.begun() && machine_.in(states(State::running, State::holding)) &&
           !machine_.does(activities(Activity::jog, Activity::homing, Activity::tool_change)) &&
           !door_open() && !loop_.failed() && rows_.may_shine();
  }
  /// Moves of a program are points on the beat, run by the job runner.
  bool beat_locked() const { return reader_.lock() != program::BeatLock::off; }
  /// A job of points that came in frames; it may be complete.
  bool wire_job() const { return runner_.begun() && !beat_locked(); }
  /// A job is in progress, also in hold, with an open door, or still stopping: one host has begun
  /// it, and other hosts are ignored. An alarm ends that: nothing moves, and unlocking ends the
  /// job.
  bool job_unfinished() const {
    return !machine_.locked() && machine_.activity() != Activity::none && !machine_.homes();
  }
  bool program_unfinished() const {
    return reader_.line_open() || !program_.idle() || (beat_locked() && !runner_.drained());
  }
  Outputs outputs() const {
    Outputs outputs;
    outputs.drives_enable = drives_.on(0) && drives_may_be_on();
    if (!drives_.all_on()) return outputs;
    outputs.fire_enable = shots_.permitted();
    // These outlast the permission by a shot that the hardware has decided, except in an alarm.
    if (machine_.locked()) return outputs;
    outputs.shutters = shots_.beam().shutters();
    outputs.attenuator = shots_.beam().attenuator();
    outputs.laser_enable = laser_may_shine();
    return outputs;
  }
  SwitchedOutputs switched_outputs() const {
    return {drives_.on(1) && drives_may_be_on(),
            program_outputs_.air() && machine_.state() != State::door, program_outputs_.aux()};
  }
  bool nothing_is_under_way() const;
  /// In a tool change, dark, until the user moves the machine.
  bool waits_for_tool() const { return machine_.changes_tool() && motion_.at_rest(); }
  /// Settings and what programs keep may be changed.
  bool may_be_changed() const;
  bool start_up_waits() const;
  /// The host of a job has sent a frame within the time of the dead man.
  bool host_lives() const;
  BeatReason idle_reason() const;
  StepPosition steps_at_rest() const;

  const InterruptMask mask_;
  const BoardFeatures board_;
  settings::Values stored_;
  settings::Values values_;  ///< stored, with the overrides of the job
  bool overridden_ = false;
  link::Link link_;
  lamp::BeatClock clock_;
  lamp::ShotScheduler shots_;
  MotionOutput motion_;
  Planning planning_;
  JobRunner runner_;
  ProgramRunner program_{clock_, motion_, planning_};
  RowJob rows_{program_};
  ProgramOutputs program_outputs_{motion_.changes()};
  ProgramReader reader_{program_, runner_, program_outputs_};
  InputWait input_wait_;
  [[no_unique_address]] TemperatureLoop loop_;
  IdleRelease drives_;
  program::PulseDecoder decoder_;
  StepLimits work_space_;
  StatusReporter reporter_;
  InputSet inputs_ = 0;  ///< active
  Parking parking_;
  MoveGuard guard_;
  Homing homing_;
  ProbeResult probe_;
  Machine machine_;
  Overrides overrides_;
  bool dry_ = false;
  Refusal refusal_ = Refusal::none;  ///< of lines of programs
  bool moving_ = false;              ///< motion was permitted at the last prepare()
  bool loader_requested_ = false;
  bool own_line_ = false;           ///< a start-up line is open: no answer is expected
  std::uint8_t start_up_next_ = 0;  ///< start-up line to be run
  /// Lines that waited when a jog was cancelled: their jogs are void.
  std::uint32_t lines_at_cancel_ = 0;
  std::int32_t next_beat_milli_hz_ = 0;  ///< lamp frequency to be applied at rest; 0 = none
  std::uint64_t now_ = 0;                ///< clock of the last prepare()
  std::uint64_t last_frame_ = 0;         ///< clock of the last prepare() after a frame
};

}  // namespace lamplock::machine
