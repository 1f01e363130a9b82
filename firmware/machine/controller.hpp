// The controller: the whole firmware core as one plain object, as boards see it. Its layers are in
// parts.hpp.
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
//   set_host_present    main loop             1 ms              the host is present, or not
//   new_connection      main loop             on change         before the first bytes of another
//                                                               host, or of one that was absent
//   measure_sensor      main loop             before prepare    voltage of a temperature sensor
//   look_ahead          main loop             before prepare    unmasked part of prepare
//   prepare             main loop             1 ms              state; true: a plan is due
//   plan                main loop, or         when due          a slice of planning, up to 10 ms,
//                       another core alone                      of a path with jerk 20 ms
//   missing_planner,    main loop             before prepare    the planner to load before anything
//   set_loaded_planner                                          is planned (planning.hpp)
//   stage               main loop             before commit     unmasked part of commit
//   commit              main loop             after prepare     hands motion out
//   part_waits          main loop             after commit      stage and commit again at once
//   service_host        main loop             1 ms              lines, answers
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

#include "firmware/machine/console.hpp"

namespace lamplock::machine {

class Controller : private MachineConsole {
 public:
  [[gnu::cold]] explicit Controller(const settings::Values& stored = settings::Values{},
                                    const InterruptMask& mask = {},
                                    const BoardFeatures& board = {});

  // Main loop.
  /// Bytes that can be received now: for lines at most the room of the queue. At least this much is
  /// available for frames in a job.
  using MachineConsole::receive_room;
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
  using MachineWork::lose_lines;
  /// Whether the host can stop the machine: `present` is false if its cable is out, its computer
  /// sleeps, or its program has closed the port. Its motion is held then.
  void set_host_present(bool present) {
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
  /// Voltage of the temperature sensor, 65536 = 3.3 V, at least every 1 ms; for boards that have
  /// one (BoardFeatures::has_sensor).
  void measure_sensor(std::uint16_t level) { loop_.measure(level); }
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
  void service_host() {
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
  using MachineConsole::set_kept;
  using MachineWork::change_beat;
  /// The user has requested the boot loader of the board; the machine is at rest and stays so.
  bool loader_requested() const { return loader_requested_; }
  /// The board has disabled the drives for a while: steps wait until they hold again.
  void drives_were_off() { drives_.were_off(); }
  using MachineParts::report_message;

  /// The planner that the board must load, none if there is no need
  /// (BoardFeatures::loads_planners). Until it is loaded nothing is planned: no slice runs, and
  /// none begins.
  PlannerKind missing_planner() const { return planning_.missing_planner(); }
  /// The planner that may run: none from the first change of its memory on.
  void set_loaded_planner(PlannerKind kind) { planning_.set_loaded(kind); }

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

  // Outputs, and what boards, tests and simulators read; parts.hpp.
  using MachineParts::fire_timing, MachineParts::outputs, MachineParts::switched_outputs;
  const settings::Values& values() const { return values_; }
  /// Without the overrides of a job.
  const settings::Values& stored() const { return stored_; }
  wire::MachineState state() const { return wire_state(machine_.state(), machine_.activity()); }
  const Machine& machine() const { return machine_; }
  using MachineParts::job_unfinished;
  const lamp::BeatClock& clock() const { return clock_; }
  const lamp::ShotScheduler& shots() const { return shots_; }
  const JobRunner& runner() const { return runner_; }
  const ProgramRunner& program() const { return program_; }
  const ProgramReader& reader() const { return reader_; }

  // Calls of the link (LinkSink); not for boards.
  using MachineConsole::fill_status, MachineConsole::status_summary;
  using MachineConsole::on_line, MachineConsole::on_line_too_long, MachineConsole::on_realtime;
  using MachineWork::on_begin, MachineWork::on_command, MachineWork::on_data, MachineWork::on_end;
  std::uint32_t refused_value() const { return refused_value_; }
};

/// The whole core fits the RP2040 with a large margin.
static_assert(sizeof(Controller) < 160 * 1024);

}  // namespace lamplock::machine
