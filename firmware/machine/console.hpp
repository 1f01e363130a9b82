// The console: lines of the host in their order, "$" commands, real-time bytes, reports.
//
// In:  lines and bytes that the link has found.
// Out: answers, reports; calls of the activities; events of the machine; settings to be stored.
// Who: the controller, main loop, unmasked: each function masks where it changes what interrupts
//      use.
#pragma once

#include "firmware/machine/console/persistent_state.hpp"
#include "firmware/machine/work.hpp"

namespace lamplock::machine {

class MachineConsole : public MachineWork {
 protected:
  using MachineWork::MachineWork;

  // Lines (console_lines.cpp).
  std::size_t receive_room() const;
  void on_line(std::string_view line);
  void on_line_too_long();
  /// Called in every round of the main loop.
  bool lines_due() const {
    return reader_.line_open() || reader_.lines_wait() || start_up_next_ < start_up_lines ||
           machine_.homes();
  }
  void work_lines();

  // Commands (console_commands.cpp).
  void set_kept(const PersistentState& kept);
  const PersistentState* changed_kept();

  // Bytes (console_realtime.cpp).
  void on_realtime(std::uint8_t byte);

  // Reports (console_status.cpp).
  /// Waits for room: a host that reads no answers gets its status later.
  void send_status_line();
  /// The only part changed by interrupts, the lamp's lock, is a single read: not masked.
  wire::StatusSummary status_summary() const {
    wire::StatusSummary summary{wire_state(machine_.state(), machine_.activity()),
                                machine_.hold_reason(), machine_.alarm(), clock_.locked(),
                                runner_.queue().free()};
    if (rows_.active()) add_rows(summary);
    return summary;
  }
  void fill_status(wire::Status& status) const;

  bool status_line_due_ = false;    ///< requested by `?`
  bool before_jog_cancel_ = false;  ///< for the bytes that are being received
  bool store_due_ = false;          ///< settings have changed
  bool kept_due_ = false;           ///< texts or places have changed

 private:
  bool lines_are_held() const;
  [[gnu::cold]] bool begin_users_lines();
  bool begins_at_once(std::string_view line) const;
  void begin_program();
  bool finish_line();
  [[gnu::cold]] void leave_work_space();
  [[gnu::cold]] void report_end();
  [[gnu::cold]] void report_about(std::string_view line);
  void begin_line(std::string_view line);
  void stop_after(GcodeError error);
  GcodeError keep_start_up_line(std::string_view line);
  void keep_new_start_up_line();
  bool run_start_up_line();
  void answer_system_command(std::string_view line);
  GcodeError system_command(std::string_view line);
  GcodeError command_at_rest(std::string_view line);
  GcodeError request_loader();
  bool send_report(std::string_view command);
  void report_version();
  void report_start_up_lines();
  void list_settings();
  GcodeError keep_build_text(std::string_view text);
  GcodeError change_setting(std::string_view line);
  [[gnu::cold]] bool may_change_in_estop(settings::Id id);
  GcodeError refuse_for_board(const settings::Values& values);
  [[gnu::cold]] GcodeError refuse_number(std::uint16_t number, std::string_view reason);
  [[gnu::cold]] GcodeError refuse_for_drives(const settings::Values& values);
  [[gnu::cold]] GcodeError refuse_settings(const settings::Values& values, std::uint16_t setting);
  void take_over(const settings::Values& values);
  void restore_defaults();
  void restore_everything();
  static void change_override(std::uint8_t& percent, int by);
  void override_byte(std::uint8_t byte);
  bool toggle_coolant(std::uint8_t byte);
  std::string_view state_name() const;
  ReportedStatus reported_status() const;
  void add_beats(TextLine& line) const;
  [[gnu::cold]] void add_rows(wire::StatusSummary& summary) const;

  std::uint8_t new_start_up_ = start_up_lines;  ///< to be kept after it has run; this value = none
  KeptText new_start_up_text_;
};

}  // namespace lamplock::machine
