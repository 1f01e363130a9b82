// The controller: the whole firmware core as one plain object.
//
// The board calls the core; the core never calls the board. All state is inside, so that several
// can live in one process. Calls by the board:
//
//   function            called from           at least every    purpose
//   receive_realtime    main loop             before receive    commands of one byte, which bypass
//                                                               the lines before them
//   receive, transmit   main loop             1 ms              bytes of the host
//   receive_room        main loop             before receive    maximum size of the next receive
//   lose_lines          main loop             on a loss         bytes of the host are missing
//   see_host            main loop             1 ms              the host is present, or not
//   new_connection      main loop             on change         before the first bytes of another
//                                                               host, or of one that was absent
//   look_ahead          main loop             before prepare    unmasked part of prepare
//   prepare             main loop             1 ms              state; true: a plan is due
//   plan                main loop, or         when due          a slice of planning, up to 10 ms,
//                       another core alone                      of a path with jerk 20 ms
//   stage               main loop             before commit     unmasked part of commit
//   commit              main loop             after prepare     hands motion out
//   part_waits          main loop             after commit      stage and commit again at once
//   tell                main loop             1 ms              lines, answers
//   input_changed       main loop             on change         switches (inputs.hpp), and the
//                                                               position at the change for guarded
//                                                               moves; at power-up for each active
//                                                               input
//   lattice_stopped,    main loop             on an e-stop, or  the position of the axes
//   stopped_at                                when ticks end
//   take_settings,      main loop             before prepare    data to be stored
//   take_kept
//   set_kept            once                  before all else   stored data
//   loader_requested    main loop             1 ms              restart into the boot loader
//   fill                fill interrupt        2 ms ahead        steps and lattice bits
//   next_span           timing interrupt      up to 1 ms ahead  lengths of ticks
//   lamp_edge           beat interrupt        on LAMP SYNC      edge and whether it fired
//   next_token          beat interrupt        250 us            the right to the next shot; after
//                                                               each edge as well
//   token_expired       beat interrupt        at its tick       the token was withdrawn
//   photosensors        beat interrupt        250 us            which have answered
//   play_changes        beat interrupt        100 us            outputs of programs
//   outputs,            anywhere              after each call   outputs that may be on
//   switched_outputs
//
// The main loop shares data with the beat and fill interrupts. The board masks them round
// prepare(), commit(), input_changed() and stopped_at(), each some 0.2 ms at most; receive() masks
// them itself where necessary (InterruptMask), since most of its time uses unshared data; plan()
// may be interrupted at any time, and works slice by slice: the main loop runs between two of them.
// On a board with two cores the other core plans whenever plan_waits(), and the main loop never
// does: all other calls are the main loop's. job_runner.hpp and work_exchange.hpp list the data
// that both may use, and when.
//
// Safety: outputs().fire_enable is false in all doubtful states; a board must disable firing within
// one call of a change, and the hardware must do so by itself on an e-stop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/lamp/beat_clock.hpp"
#include "firmware/lamp/shot_scheduler.hpp"
#include "firmware/link/link.hpp"
#include "firmware/machine/activities/homing.hpp"
#include "firmware/machine/activities/parking.hpp"
#include "firmware/machine/activities/program_reader.hpp"
#include "firmware/machine/activities/row_job.hpp"
#include "firmware/machine/console/persistent_state.hpp"
#include "firmware/machine/console/program_text.hpp"
#include "firmware/machine/console/status_report.hpp"
#include "firmware/machine/inputs/input_wait.hpp"
#include "firmware/machine/inputs/inputs.hpp"
#include "firmware/machine/inputs/move_guard.hpp"
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
#include "shared/wire/status.hpp"
#include "shared/work_space.hpp"

namespace lamplock::machine {

/// Capabilities of the board.
struct BoardFeatures {
  int axes = max_axes;          ///< with outputs; jobs with more are refused
  std::uint8_t channels = 0xf;  ///< a bit for each beam channel with a shutter
  InputSet inputs = all_inputs & ~set_of(Input::limit_chain) & ~set_of(Input::aux);
  std::uint8_t outputs = 0;      ///< a bit for each that programs may switch
  std::uint8_t second_wire = 0;  ///< a bit for each axis whose drive has the second enable
  /// How it accepts motion; HandoutMode::staged with stage() before each commit().
  HandoutMode parts = HandoutMode::straight;
};

/// Outputs that may be on.
struct Outputs {
  bool fire_enable = false;
  bool drives_enable = false;
  std::uint8_t shutters = 0;     ///< bit 0 = first channel; 1 = open; never two at a time
  std::uint16_t attenuator = 0;  ///< 65535 = full
  /// A continuous laser may shine while the gate bit of the lattice is set; LASER PWM is its power
  /// then, not the attenuator.
  bool laser_enable = false;
};

/// Outputs switched by programs, and the second enable: for boards that have such pins.
struct SwitchedOutputs {
  bool z_enable = false;
  bool air = false;
  std::uint16_t aux = 0;  ///< 65535 = on
};

/// Until when lines of programs are refused.
enum class Refusal : std::uint8_t {
  none,
  until_unlocked,  ///< after an error ($981): to the next `$X` or reset
  until_reset      ///< lines were lost
};

/// Timing of the board's fire stage, from the settings.
struct FireTiming {
  std::uint32_t delay_clocks = 0;  ///< LAMP SYNC to Q-switch (lamp/shot_delay.hpp)
  std::uint32_t width_clocks = 0;  ///< of the Q-switch pulse
  bool own_edges = false;          ///< free beat: the trigger output is the LAMP SYNC
};

/// Progress of a job that must survive a restart. The number of flashes already fired at that point
/// does not.
struct ResumePoint {
  /// Programs have no sessions, and hosts never choose this one.
  static constexpr std::uint32_t of_program = 0xffffffff;

  std::uint32_t session = 0;  ///< 0 = no motion, or only motion that has ended
  std::uint32_t first_unfired = 0;
  bool shot_out = false;  ///< the board may have fired that point
};

/// Clocks from the edge to the decision whether to fire: runt filter (2 us) and latency of the fire
/// stage. Calculated for the PIO of the RP2040; the virtual board does the same.
inline constexpr std::uint32_t fire_decision_clocks = 269;

class Controller {
 public:
  [[gnu::cold]] explicit Controller(const settings::Values& stored = settings::Values{},
                                    const InterruptMask& mask = {},
                                    const BoardFeatures& board = {});
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  // Main loop.
  /// Bytes that can be received now: for lines at most the room of the queue. At least this much is
  /// available for frames in a job.
  std::size_t receive_room() const;
  /// `before_jog_cancel`: the bytes were sent before an end of jogs (0x85) that has been received;
  /// jogs among them are void.
  void receive(std::span<const std::uint8_t> bytes, bool before_jog_cancel = false);
  /// A command of one byte, removed from the stream where it arrived. Unknown ones are ignored.
  void receive_realtime(std::uint8_t byte) {
    last_byte_ = now_;
    on_realtime(byte);
  }
  /// Bytes of the host are missing: a line may be lost without a trace. Received lines run to their
  /// end; no line of a program begins before a reset.
  [[gnu::cold]] void lose_lines();
  /// Whether the host can stop the machine: `present` is false if its cable is out, its computer
  /// sleeps, or its program has closed the port. Its motion is held then.
  void see_host(bool present) {
    if (present == host_present_) return;
    host_present_ = present;
    if (!present) lose_host();
  }
  /// Bytes from here on are unrelated to earlier ones: half a line or frame is dropped, a job
  /// continues. Uses no data that is shared with interrupts.
  [[gnu::cold]] void new_connection() {
    link_.new_connection();
    status_line_due_ = false;
    if (refusal_ == Refusal::until_reset && !job_unfinished()) refusal_ = Refusal::none;
  }
  std::size_t transmit(std::span<std::uint8_t> out) { return link_.transmit(out); }
  /// Not masked, directly before prepare(): shortens it.
  void look_ahead() {
    if (runner_.begun() && moving_) runner_.look_ahead();
  }
  bool prepare(std::uint64_t clock);
  /// Not masked, before commit() (HandoutMode::staged): shortens it.
  void stage() {
    if (moving_) runner_.stage();
    program_.stage();
  }
  /// True if motion was handed out.
  bool commit();
  /// There is room for another part of the plan now: call stage() and commit() again. False in a
  /// hold or an alarm, and where one is due.
  bool part_waits() const { return moving_ && !runner_.underrun() && runner_.part_waits(); }
  /// Not masked: continues the lines of a program, and makes a STATUS that is due, masking only to
  /// read the machine's part.
  void tell() {
    if (parking_.stage() != Parking::Stage::off) work_parking();
    if (lines_due()) work_lines();
    if (status_line_due_) send_status_line();
    link_.poll(*this);
  }
  /// `at`: the position of the motors, from the steps put out, when the pin changed; needed while
  /// wants_places().
  [[gnu::cold]] void input_changed(Input input, bool active, const StepPosition& at = {});
  /// A guarded move is in progress.
  bool wants_places() const { return guard_.watches(); }
  /// A switch or a key may interrupt the motion: the less is filled ahead the better.
  bool may_abort_move() const { return guard_.watches() || machine_.jogs(); }
  /// The board restarts after a crash during a job: the position of the axes is unknown.
  void start_in_alarm() { raise_alarm(alarm_position_lost); }
  /// The board's ticks have run out: motion, if there was any, has stopped dead. Must be followed
  /// by stopped_at().
  void lattice_stopped() {
    if (!runner_.at_rest()) raise_alarm(alarm_position_lost);
  }
  /// The board has discarded the ticks it had (e-stop): the actual position of the motors.
  [[gnu::cold]] void stopped_at(const StepPosition& motors);

  /// The user has changed settings: true once, with the values to be stored before the answer is
  /// transmitted. Until the next prepare() the machine is at rest, even if a job has just begun.
  bool take_settings(settings::Values& values);
  bool settings_due() const { return store_due_; }
  /// The same for the data that programs keep; null if there is none to store. Valid until the next
  /// line is read.
  const PersistentState* take_kept() {
    const bool due = kept_due_ || reader_.kept().parameters.changed != 0;
    return due ? changed_kept() : nullptr;
  }
  /// Once, before anything else: the data kept over power-off.
  void set_kept(const PersistentState& kept);
  /// The lamp changes its frequency during a job: the machine brakes to rest, follows the new beat
  /// and continues with the first point not fired; the frequency is dropped at the end of the job.
  /// Errors: no_job; locked; bad_value, with the number of the conflicting setting in
  /// refused_value(): then nothing has changed.
  [[gnu::cold]] Result change_beat(std::uint32_t milli_hz);

  /// The user has requested the boot loader of the board; the machine is at rest and stays so.
  bool loader_requested() const { return loader_requested_; }
  /// Sends "[MSG:text]" to the host.
  void say(std::string_view text);

  // Main loop, or another core that does nothing else.
  /// True if there is more to do: call it again, with other work in between.
  bool plan() { return planning_.plan(values_, stored_); }
  /// A plan is due, and no slice runs.
  bool plan_waits() const { return planning_.work_exchange().waits(); }
  /// Planned motion can be handed out and should not wait.
  bool batch_waits() const { return program_.batch_waits() || part_waits(); }
  /// A plan is being made or due: a board with two cores must ensure that this ends.
  bool planning() const { return planning_.work_exchange().busy(); }

  // Interrupts of the board.
  void fill(stepper::TickBlock& block, std::uint32_t max_ticks) {
    motion_.generator().fill(block, max_ticks);
  }
  template <class Board>
  void fill_axes(std::uint32_t ticks, Board& board) {
    motion_.generator().fill_axes(ticks, board);
  }
  lamp::TickSpan next_span(std::uint32_t max_ticks) { return clock_.next_span(max_ticks); }
  /// An edge longer than a runt; `token_spent` if it has spent a loaded token.
  void lamp_edge(std::uint64_t clock, bool fired, bool token_spent) {
    shots_.edge(clock_.edge(clock), fired, token_spent, clock);
  }
  /// Photosensors (bit 0 = first channel) whose line has risen since the last call, made at
  /// `clock`, after the edges before it.
  void photosensors(std::uint8_t answered, std::uint64_t clock) {
    shots_.photosensors(answered, clock);
  }
  /// Exact as of the last lamp_edge(). Beat interrupt, or main loop with it masked.
  ResumePoint job_mark() {
    if (program_.begun() || beat_locked()) return {ResumePoint::of_program, 0, false};
    if (!wire_job()) return {};
    return {link_.session(), runner_.first_unfired(), shots_.undecided()};
  }
  bool next_token(lamp::FireToken& token, std::uint64_t present_tick) {
    return shots_.next_token(token, clock_, present_tick);
  }
  void token_expired() { shots_.token_expired(); }
  /// The lattice has reached this tick (lower half of its number): outputs() of programs.
  void play_changes(std::uint32_t tick) { program_outputs_.play(tick); }
  /// play_changes() will be needed.
  bool changes_wait() const { return program_outputs_.changes_wait(); }
  /// The tick of the next change; false if none is known.
  bool next_change(std::uint32_t& tick) const { return program_outputs_.next_due(tick); }

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
  FireTiming fire_timing() const;
  const settings::Values& values() const { return values_; }
  /// Without the overrides of a job.
  const settings::Values& stored() const { return stored_; }
  wire::MachineState state() const { return wire_state(machine_.state(), machine_.activity()); }
  const Machine& machine() const { return machine_; }
  /// A job is in progress, also in hold, with an open door, or still stopping: one host has begun
  /// it, and other hosts are ignored. An alarm ends that: nothing moves, and unlocking ends the
  /// job.
  bool job_unfinished() const {
    return !machine_.locked() && machine_.activity() != Activity::none && !machine_.homes();
  }
  const lamp::BeatClock& clock() const { return clock_; }
  const lamp::ShotScheduler& shots() const { return shots_; }
  const JobRunner& runner() const { return runner_; }
  const ProgramRunner& program() const { return program_; }
  const ProgramReader& reader() const { return reader_; }

  // Calls of the link (LinkSink); not for boards.
  void on_realtime(std::uint8_t byte);
  void on_line(std::string_view line);
  void on_line_too_long();
  Result on_begin(const wire::JobHeader& header);
  Result on_data(std::span<const std::uint8_t> records);
  [[gnu::cold]] Result on_end(std::uint32_t total);
  [[gnu::cold]] Result on_command(const wire::CommandRequest& request);
  std::uint32_t refused_value() const { return refused_value_; }
  /// The only part changed by interrupts, the lamp's lock, is a single read: not masked.
  wire::StatusSummary standing() const {
    wire::StatusSummary standing{state(), machine_.hold_reason(), machine_.alarm(), clock_.locked(),
                                 runner_.queue().free()};
    if (rows_.active()) add_rows(standing);
    return standing;
  }
  void fill_status(wire::Status& status) const;

 private:
  // Alarm numbers of grbl 1.1; 10 as in grblHAL.
  static constexpr std::uint8_t alarm_hard_limit = 1;
  static constexpr std::uint8_t alarm_soft_limit = 2;
  static constexpr std::uint8_t alarm_position_lost = 3;  ///< "reset while in motion"
  static constexpr std::uint8_t alarm_probe_state = 4;    ///< already in its final state
  static constexpr std::uint8_t alarm_probe_nothing = 5;
  static constexpr std::uint8_t alarm_homing_reset = 6;
  static constexpr std::uint8_t alarm_homing_door = 7;
  static constexpr std::uint8_t alarm_homing_engaged = 8;    ///< after pulling off
  static constexpr std::uint8_t alarm_homing_not_found = 9;  ///< a switch
  static constexpr std::uint8_t alarm_estop = 10;
  static constexpr std::uint8_t alarm_homing_wanted = 11;
  static constexpr std::uint8_t alarm_homing_not_squared = 15;  ///< as in grblHAL
  static constexpr std::string_view unlock_text = "'$H'|'$X' to unlock";
  /// Room reserved for answers: without it lines wait.
  static constexpr std::size_t answer_room = 128;
  /// Lines leave this much in addition, so that a host that reads no answers still gets one status.
  static constexpr std::size_t status_room = TextLine::capacity;

  lamp::ShotRules shot_rules(const settings::Values& values) const;
  void hold_after_failed_shots();
  bool drives_may_be_on() const { return !machine_.in(states(State::estop, State::sleep)); }
  bool drives_may_rest() const;
  [[gnu::cold]] void outputs_off();
  [[gnu::cold]] void tell_end();
  bool work_input_wait();
  Result check_settings(const settings::Values& values, std::uint16_t& setting) const;
  Result job_settings(const wire::JobHeader& header, settings::Values& values);
  [[gnu::cold]] bool use_kinematics();
  [[gnu::cold]] void use_settings(const settings::Values& values);
  void end_overrides();
  [[gnu::cold]] void set_trigger();
  void follow_new_beat();
  // Events of the machine and what they cause (controller_states.cpp).
  Conditions conditions() const;
  [[gnu::cold]] void handle(Event event, std::uint8_t detail = 0);
  void handle(Event event, wire::HoldReason reason) {
    handle(event, static_cast<std::uint8_t>(reason));
  }
  [[gnu::cold]] void perform(Effect effect);
  [[gnu::cold]] void perform_end(Effect effect);
  [[gnu::cold]] void hold_motion();
  [[gnu::cold]] void hold_at_door();
  void brake_points();
  [[gnu::cold]] void stop_motion();
  [[gnu::cold]] void stop_lines();
  [[gnu::cold]] void stop_program();
  [[gnu::cold]] void refuse_program();
  [[gnu::cold]] void leave_guarded_motion();
  [[gnu::cold]] void finish_program();
  void raise_alarm(std::uint8_t number) { handle(Event::fault, number); }
  [[gnu::cold]] void begin_alarm(bool answers);
  [[gnu::cold]] void unlock();
  [[gnu::cold]] void begin_reset();
  [[gnu::cold]] void clear_for_reset();
  [[gnu::cold]] void greet();
  /// Ends the present activity if it is over.
  void settle();
  bool is_settled();
  bool ready_to_move() const;
  BeatReason idle_reason() const;
  void check_dead_man();
  [[gnu::cold]] void lose_host();
  [[gnu::cold]] void hold_without_host();
  void check_lamp();
  [[gnu::cold]] void miss_lamp();
  /// The host of a job has sent a frame within the time of the dead man.
  bool host_lives() const;
  // Lines and programs (controller_program.cpp).
  /// The laser of a program, in motion and while it stops; a door ends it at once.
  bool laser_may_shine() const {
    return program_.begun() && machine_.in(states(State::running, State::holding)) &&
           !machine_.does(activities(Activity::jog, Activity::homing)) && !door_open() &&
           rows_.may_shine();
  }
  bool program_unfinished() const {
    return reader_.line_open() || !program_.idle() || (beat_locked() && !runner_.drained());
  }
  /// Moves of a program are points on the beat, run by the job runner.
  bool beat_locked() const { return reader_.lock() != program::BeatLock::off; }
  /// A job of points that came in frames.
  bool wire_job() const { return runner_.begun() && !beat_locked(); }
  /// Called in every round of the main loop.
  bool lines_due() const {
    return reader_.line_open() || reader_.lines_wait() || start_up_next_ < start_up_lines ||
           homing_.active();
  }
  void work_lines();
  bool finish_line();
  void drop_open_line();
  [[gnu::cold]] void pause();
  void say_tool();
  void begin_line(std::string_view line);
  GcodeError begin_program_line(std::string_view line);
  void stop_after(GcodeError error);
  [[gnu::cold]] void refuse_lines(Refusal until, std::string_view reason);
  void end_refusal() {
    if (refusal_ == Refusal::until_unlocked) refusal_ = Refusal::none;
  }
  GcodeError begin_jog(std::string_view line);
  GcodeError keep_start_up_line(std::string_view line);
  void keep_new_start_up_line();
  bool run_start_up_line();
  bool start_up_waits() const;
  bool start_program();
  bool begin_lines(const settings::Values& values);
  void find_position();
  void begin_points(program::BeatLock lock);
  bool change_over(program::BeatLock lock);
  void configure_reader();
  [[gnu::cold]] void reject_unreachable();
  void end_program();
  void cancel_jog();
  void override_byte(std::uint8_t byte);
  void use_overrides();
  bool toggle_coolant(std::uint8_t byte);
  static void change_override(std::uint8_t& percent, int by);
  void end_overrides_of_program();
  // Jobs of rows (controller_rows.cpp).
  Result may_begin_job() const;
  Result begin_job(const wire::JobHeader& header);
  Result begin_rows(const wire::JobHeader& header, const settings::Values& values,
                    std::uint32_t tick_q16);
  Result take_rows(std::span<const std::uint8_t> records);
  Result end_rows(std::uint32_t total);
  Result set_speed_of_rows(std::uint32_t percent);
  [[gnu::cold]] void add_rows(wire::StatusSummary& standing) const;
  // Doors and parking (controller_parking.cpp).
  bool door_open() const { return (inputs_ & set_of(Input::door)) != 0; }
  void begin_parking();
  void work_parking();
  // Guarded moves (controller_homing.cpp, controller_probe.cpp).
  GcodeError begin_homing(std::string_view axes);
  void work_homing();
  void go_homing();
  void fail_homing(std::uint8_t alarm);
  void break_off_homing(std::uint8_t alarm);
  void end_homing();
  void drop_homing(bool answers);
  StepPosition steps_at_rest() const;
  [[gnu::cold]] void clear_racking();
  bool work_probe();
  void begin_probe();
  bool end_probe();

  GcodeError request_loader();
  bool nothing_is_under_way() const;
  bool may_be_changed() const;
  void answer_system_command(std::string_view line);
  GcodeError system_command(std::string_view line);
  GcodeError command_at_rest(std::string_view line);
  const PersistentState* changed_kept();
  bool tell(std::string_view command);
  void tell_version();
  void tell_offsets(int first, int end);
  void tell_start_up_lines();
  GcodeError keep_build_text(std::string_view text);
  GcodeError change_setting(std::string_view line);
  void take_over(const settings::Values& values);
  void restore_defaults();
  void restore_everything();
  void list_settings();
  void answer(GcodeError error);
  void send_banner();
  ReportedStatus reported_status() const;
  std::string_view state_name() const;
  void send_status_line();
  void add_beats(TextLine& line) const;

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
  bool dry_ = false;
  Refusal refusal_ = Refusal::none;  ///< of lines of programs
  bool host_present_ = true;         ///< from the board
  bool status_line_due_ = false;     ///< requested by `?`
  bool before_jog_cancel_ = false;   ///< for the bytes that are being received
  /// that waited when a jog was cancelled: their jogs are void
  std::uint32_t lines_at_cancel_ = 0;
  bool kept_due_ = false;                       ///< texts or places have changed
  bool own_line_ = false;                       ///< a start-up line is open: no answer is expected
  std::uint8_t start_up_next_ = 0;              ///< start-up line to be run
  std::uint8_t new_start_up_ = start_up_lines;  ///< to be kept after it has run; this value = none
  KeptText new_start_up_text_;
  Overrides overrides_;
  bool moving_ = false;                  ///< motion was permitted at the last prepare()
  std::int32_t next_beat_milli_hz_ = 0;  ///< lamp frequency to be applied at rest; 0 = none
  bool store_due_ = false;
  bool loader_requested_ = false;
  std::uint32_t points_total_ = 0;
  std::uint32_t refused_value_ = 0;
  std::uint64_t now_ = 0;            ///< clock of the last prepare()
  std::uint64_t last_frame_ = 0;     ///< clock of the last prepare() after a frame
  std::uint64_t last_byte_ = 0;      ///< the same after a byte of any kind
  std::uint64_t last_jog_ = 0;       ///< the same after a line $J
  std::uint64_t no_lamp_since_ = 0;  ///< clock since which a job waits for the lamp
  bool no_lamp_said_ = false;        ///< the host has got the message about that
  bool lamp_was_locked_ = false;     ///< at the last prepare()
};

/// The whole core fits the RP2040 with a large margin.
static_assert(sizeof(Controller) < 160 * 1024);

}  // namespace lamplock::machine
