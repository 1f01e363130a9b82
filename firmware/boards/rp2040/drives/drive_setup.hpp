// Set-up and watch of the drives that are on the board (TMC2209).
//
// In:  settings, the row of the board, bytes from the UART of the drives, the time, whether the
//      machine is at rest. Out: bytes to it; whether the drives may be enabled; messages.
// Who: the board's main loop, service() once a round, which never waits. `Uart` is DriveUart
//      (drive_uart.hpp) or a test's.
//
// First every drive on the wire gets its delay of replies, without a question: until all have it
// none may answer (tmc2209.hpp, nodeconf).
// Set-up, axis by axis: read IFCNT; write the registers; read back those that can be read; IFCNT
// must have counted every write, for those that cannot; GSTAT must not have seen a reset. When all
// axes are set up, GSTAT and IFCNT of every axis are read once more. Only then may the drives be
// enabled.
//
//   setting_up --> watching       all axes are set up: enabled as the machine asks for
//        |  ^         |           at rest, an axis every 100 ms: reset, foreign writes, heat,
//        shorts v  |         v
//       failed <------+           disabled; a message with the remedy; again after 0.5 s
//
// Every exchange compares its echo: what is sent on the one wire comes back. A damaged or missing
// answer is repeated twice from the beginning of its axis, then it is a failure.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/boards/rp2040/drives/tmc2209.hpp"
#include "shared/text_line.hpp"

namespace lamplock::rp2040 {

// Cold code does not inline the length of a string.
using std::string_view_literals::operator""sv;

template <class Uart>
class DriveSetup {
 public:
  enum class State : std::uint8_t { off, setting_up, watching, failed };

  DriveSetup(Uart& uart, const boards::UartDrives& row) : uart_(uart), row_(row) {}

  /// Begins the set-up, if these values are others; drives are not enabled meanwhile. `unfit`:
  /// number of a setting that the board does not permit, 0 = none: then no drive is set up.
  [[gnu::cold]] void begin(const settings::Values& values, int axes, std::uint16_t unfit,
                           std::uint32_t now_us) {
    bool is_same = state_ == State::watching && unfit == 0;
    for (int a = 0; a < max_axes; ++a) {
      const tmc::Config config = tmc::config_of(values, a);
      is_same = is_same && config == configs_[a];
      configs_[a] = config;
    }
    if (is_same) return;
    axes_ = axes;
    unfit_ = unfit;
    reported_ = fault_ = Fault::none;
    warned_ = 0;
    restart(now_us);
  }
  /// One round of the main loop. `say(line)` reports a message.
  template <class Say>
  [[gnu::cold]] void service(std::uint32_t now_us, bool at_rest, Say&& say) {
    if (state_ == State::off) return;
    if (unfit_ != 0) return refuse_setting(say);
    if (!exchanging_ && static_cast<std::int32_t>(now_us - wake_us_) < 0) return;
    if (state_ == State::watching && !exchanging_ && !at_rest) return;
    if (state_ == State::failed) restart(now_us);
    if (!exchanging_) return ask(now_us);
    if (!complete(now_us)) return;
    exchanging_ = false;
    if (is_undamaged())
      advance(now_us);
    else if (++failures_ > max_repeats)
      fail(is_echo_ && count_ <= sent_ ? Fault::silent : Fault::damaged, now_us);
    else
      repeat();
    report(say);
  }
  /// The drives may be enabled.
  bool ready() const { return is_set_up_; }
  bool failed() const { return state_ == State::failed; }
  /// The first set-up has ended, well or not.
  bool settled() const { return state_ != State::setting_up || reported_ != Fault::none; }

 private:
  enum class Fault : std::uint8_t {
    none,
    silent,
    damaged,
    not_taken,
    reset,
    low_supply,
    heat,
    was_off,
    shorted
  };
  enum class Step : std::uint8_t {
    delay,
    count_before,
    write,
    read_back,
    count_after,
    look,
    status
  };

  static constexpr int max_axes = 4;
  static constexpr unsigned max_repeats = 2;
  static constexpr std::uint32_t retry_us = 500'000, watch_us = 100'000;
  /// 12 bytes at 115200 baud and the delay of the reply take 1.2 ms; a longer pause than 63 bits
  /// makes a drive forget half a datagram.
  static constexpr std::uint32_t timeout_us = 5'000;

  void restart(std::uint32_t now_us) {
    state_ = State::setting_up;
    is_set_up_ = is_checking_ = exchanging_ = false;
    axis_ = 0;
    failures_ = 0;
    step_ = Step::delay;
    wake_us_ = now_us;
  }
  void begin_axis() {
    step_ = Step::count_before;
    place_ = 0;
  }
  void repeat() {
    // The same question again.
    if (state_ == State::watching || step_ == Step::delay) return;
    if (is_checking_) {
      step_ = Step::look;
      return;
    }
    begin_axis();
  }

  // One exchange.
  std::uint8_t address() const { return row_.addresses[static_cast<std::size_t>(axis_)]; }
  std::uint8_t asked_register() const {
    switch (step_) {
      case Step::delay:
        return tmc::nodeconf;
      case Step::count_before:
      case Step::count_after:
        return tmc::ifcnt;
      case Step::look:
        return place_ == 0 ? tmc::gstat : tmc::ifcnt;
      case Step::status:
        return tmc::drv_status;
      default:
        return tmc::written[place_];
    }
  }
  void ask(std::uint32_t now_us) {
    const std::uint8_t reg = asked_register();
    const bool writes = is_writing();
    sent_ = static_cast<std::uint8_t>(writes ? tmc::full_bytes : tmc::request_bytes);
    out_ = writes ? tmc::write_datagram(address(), reg, value_of(reg))
                  : tmc::read_datagram(address(), reg);
    while (uart_.read() >= 0) {
    }
    for (std::uint8_t i = 0; i < sent_; ++i) uart_.write(out_[i]);
    count_ = 0;
    is_echo_ = true;
    exchanging_ = true;
    begun_us_ = now_us;
  }
  std::uint32_t value_of(std::uint8_t reg) const {
    return tmc::value_of(reg, configs_[axis_], row_.sense_mohm);
  }
  bool is_writing() const { return step_ == Step::write || step_ == Step::delay; }
  unsigned wanted_bytes() const { return is_writing() ? sent_ : sent_ + unsigned{tmc::full_bytes}; }
  /// Takes bytes; true if all have come, or none will.
  bool complete(std::uint32_t now_us) {
    const unsigned wanted = wanted_bytes();
    for (int byte; count_ < wanted && (byte = uart_.read()) >= 0; ++count_) {
      const auto value = static_cast<std::uint8_t>(byte);
      if (byte > 0xff) is_echo_ = false;  // an error of the frame
      if (count_ < sent_)
        is_echo_ = is_echo_ && value == out_[count_];
      else
        in_[count_ - sent_] = value;
    }
    return count_ == wanted || now_us - begun_us_ > timeout_us;
  }
  bool is_undamaged() const {
    return count_ == wanted_bytes() && is_echo_ &&
           (is_writing() || tmc::is_reply(in_, asked_register()));
  }

  // What follows from its answer.
  void advance(std::uint32_t now_us) {
    const std::uint32_t value = is_writing() ? 0 : tmc::data_of(in_);
    switch (step_) {
      case Step::delay:
        failures_ = 0;
        if (++axis_ < max_axes) break;
        axis_ = 0;
        begin_axis();
        break;
      case Step::count_before:
        counts_[axis_] = static_cast<std::uint8_t>(value);
        step_ = Step::write;
        break;
      case Step::write:
        ++counts_[axis_];
        if (++place_ == tmc::written.size()) {
          step_ = Step::read_back;
          place_ = 0;
          skip_unreadable();
        }
        break;
      case Step::read_back:
        if (value != value_of(tmc::written[place_])) return set_up_again(now_us);
        ++place_;
        skip_unreadable();
        break;
      case Step::count_after:
        if (value != counts_[axis_]) return set_up_again(now_us);
        next_axis(now_us);
        break;
      case Step::look:
        look(value, now_us);
        break;
      case Step::status:
        take_status(value, now_us);
        break;
    }
  }
  void skip_unreadable() {
    while (place_ < tmc::written.size() && !tmc::is_readable(tmc::written[place_])) ++place_;
    if (place_ == tmc::written.size()) step_ = Step::count_after;
  }
  void set_up_again(std::uint32_t now_us) {
    if (++failures_ > max_repeats) return fail(Fault::not_taken, now_us);
    begin_axis();
  }
  void next_axis(std::uint32_t now_us) {
    failures_ = 0;
    place_ = 0;
    if (++axis_ < axes_) {
      if (!is_checking_) begin_axis();
      if (state_ == State::watching) wake_us_ = now_us + watch_us;
      return;
    }
    axis_ = 0;
    step_ = Step::look;
    if (!is_checking_) {
      is_checking_ = true;
      return;
    }
    wake_us_ = now_us + watch_us;
    if (state_ == State::watching) return;
    state_ = State::watching;
    is_set_up_ = true;
    reported_ = Fault::none;
  }
  /// GSTAT, then IFCNT.
  void look(std::uint32_t value, std::uint32_t now_us) {
    if (place_ == 0) {
      if ((value & tmc::gstat_reset) != 0) return fail(Fault::reset, now_us);
      if ((value & tmc::gstat_uv_cp) != 0) return fail(Fault::low_supply, now_us);
      was_off_ = (value & tmc::gstat_drv_err) != 0;
      place_ = 1;
      return;
    }
    if (value != counts_[axis_]) return fail(Fault::not_taken, now_us);
    step_ = Step::status;
  }
  void take_status(std::uint32_t value, std::uint32_t now_us) {
    if ((value & tmc::shorts) != 0) return fail(Fault::shorted, now_us);
    if ((value & tmc::too_hot) != 0) return fail(Fault::heat, now_us);
    if (was_off_) return fail(Fault::was_off, now_us);
    const auto bit = static_cast<std::uint8_t>(1u << axis_);
    const bool is_warm = (value & tmc::warm) != 0;
    warns_ = is_warm && (warned_ & bit) == 0;
    warned_ = static_cast<std::uint8_t>(is_warm ? warned_ | bit : warned_ & ~bit);
    warm_axis_ = axis_;
    step_ = Step::look;
    next_axis(now_us);
  }
  void fail(Fault fault, std::uint32_t now_us) {
    fault_ = fault;
    fault_axis_ = axis_;
    state_ = State::failed;
    is_set_up_ = is_checking_ = false;
    wake_us_ = now_us + retry_us;
  }

  // Messages.
  template <class Say>
  void refuse_setting(Say& say) {
    state_ = State::failed;
    if (reported_ != Fault::none) return;
    reported_ = Fault::not_taken;
    TextLine line;
    line.add("Drives off: $"sv)
        .add(std::int64_t{unfit_})
        .add(" is not permitted on this board; "sv);
    line.add("change it"sv);
    say(line.view());
  }
  template <class Say>
  void report(Say& say) {
    if (warns_) {
      warns_ = false;
      TextLine line;
      line.add("Drive "sv).add(axis_name(warm_axis_)).add(" is warm: above 120 C; lower $"sv);
      line.add(std::int64_t{settings::number(settings::Id::drive_current_x)} + warm_axis_);
      line.add(" or cool it"sv);
      say(line.view());
    }
    if (state_ != State::failed || reported_ == fault_) return;
    reported_ = fault_;
    TextLine line;
    line.add("Drives off: "sv).add(axis_name(fault_axis_)).add(text_of(fault_));
    say(line.view());
  }
  static std::string_view axis_name(int axis) {
    static constexpr std::array<char, max_axes> names{'X', 'Y', 'Z', 'A'};
    return {&names[static_cast<std::size_t>(axis)], 1};
  }
  static std::string_view text_of(Fault fault) {
    switch (fault) {
      case Fault::silent:
        return " does not answer; switch the supply of the motors on"sv;
      case Fault::damaged:
        return " answers with errors; check its supply and the wires near it"sv;
      case Fault::not_taken:
        return " does not keep its set-up; check its supply"sv;
      case Fault::reset:
        return " was reset; check the supply of the motors, then home"sv;
      case Fault::low_supply:
        return " has too low a supply; check the supply of the motors, then home"sv;
      case Fault::was_off:
        return " was off for heat or a short; check its motor's wires and its current, then home"sv;
      case Fault::heat:
        return " is too hot; let it cool and lower its current"sv;
      default:
        return " has a short; switch off and check its motor's wires"sv;
    }
  }

  Uart& uart_;
  const boards::UartDrives& row_;
  tmc::Config configs_[max_axes] = {};
  tmc::Datagram out_{}, in_{};
  std::uint32_t wake_us_ = 0, begun_us_ = 0;
  std::uint16_t unfit_ = 0;
  std::uint8_t counts_[max_axes] = {};  ///< IFCNT as it must be
  int axes_ = 0, axis_ = 0, fault_axis_ = 0, warm_axis_ = 0;
  std::uint8_t sent_ = 0, count_ = 0;  ///< bytes of the exchange
  std::uint8_t place_ = 0;             ///< in tmc::written; of `look` 0 or 1
  std::uint8_t warned_ = 0;            ///< axes whose warmth was reported
  unsigned failures_ = 0;
  State state_ = State::off;
  Step step_ = Step::count_before;
  Fault fault_ = Fault::none, reported_ = Fault::none;
  bool exchanging_ = false, is_echo_ = false, is_set_up_ = false, warns_ = false;
  bool was_off_ = false;      ///< the drive has switched itself off since GSTAT was cleared
  bool is_checking_ = false;  ///< all axes are written: the round that only looks, then the watch
};

}  // namespace lamplock::rp2040
