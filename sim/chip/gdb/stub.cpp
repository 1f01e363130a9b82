#include "sim/chip/gdb/stub.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <optional>
#include <vector>

#include "sim/chip/gdb/documents.hpp"

namespace lamplock::sim::chip::gdb {

namespace {

// Numbers of signals in GDB's own table (include/gdb/signals.def).
constexpr unsigned signal_interrupt = 2, signal_trap = 5;
constexpr int core_count = 2;

// Errors: a debugger does not distinguish their numbers.
constexpr std::string_view ok = "OK", malformed = "E01", no_memory = "E02", no_thread = "E03";

bool take(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// Removes a hexadecimal number from the start of a text and returns it.
std::optional<std::uint32_t> take_number(std::string_view& text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

/// Two numbers with a separator, as "addr,length".
struct Pair {
  std::uint32_t first, second;
};
std::optional<Pair> take_pair(std::string_view& text, std::string_view between = ",") {
  const auto first = take_number(text);
  if (!first || !take(text, between)) return std::nullopt;
  const auto second = take_number(text);
  if (!second) return std::nullopt;
  return Pair{*first, *second};
}

/// A word as registers are written: its bytes in the order of memory.
std::string word_hex(std::uint32_t word) {
  std::array<std::uint8_t, 4> bytes;
  std::memcpy(bytes.data(), &word, sizeof word);
  return to_hex(bytes);
}

std::optional<std::uint32_t> word_from_hex(std::string_view text) {
  const auto bytes = from_hex(text);
  if (!bytes || bytes->size() != 4) return std::nullopt;
  std::uint32_t word = 0;
  std::memcpy(&word, bytes->data(), sizeof word);
  return word;
}

std::string number(std::uint32_t value) {
  std::array<char, 8> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, 16).ptr;
  return {digits.data(), end};
}

std::span<const std::uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// A thread as packets name it. -1: all, 0: any.
std::optional<int> take_thread(std::string_view& text) {
  if (take(text, "-1")) return -1;
  const auto value = take_number(text);
  if (!value || *value > core_count) return std::nullopt;
  return static_cast<int>(*value);
}

}  // namespace

// --- Packets -------------------------------------------------------------------------------------

void Stub::receive(std::span<const std::uint8_t> bytes) {
  packets_.receive(bytes);
  while (const auto received = packets_.next()) {
    if (received->interrupt) {
      if (running_) {
        halt({Stop::Reason::none, general_core_, 0, WatchKind::write}, signal_interrupt);
        packets_.send(stop_reply());
      }
      continue;
    }
    if (running_) halt({}, signal_trap);
    const std::string reply = answer(received->payload);
    if (running_ || killed_) continue;  // the answer is the next stop
    packets_.send(reply);
    if (received->payload == "QStartNoAckMode") packets_.stop_acknowledging();
    if (received->payload == "D" || received->payload.starts_with("D;")) running_ = true;
  }
}

std::string Stub::answer(std::string_view packet) {
  if (packet.empty()) return {};
  const std::string_view rest = packet.substr(1);
  switch (packet.front()) {
    case '?':
      return stop_reply();
    case 'g':
      return read_registers();
    case 'G':
      return write_registers(rest);
    case 'p':
      return read_register(rest);
    case 'P':
      return write_register(rest);
    case 'm':
      return read_memory(rest);
    case 'M':
    case 'X':
      return write_memory(rest, packet.front() == 'X');
    case 'Z':
    case 'z':
      return breakpoint(rest, packet.front() == 'Z');
    case 'H':
      return select_thread(rest);
    case 'T':
      return thread_alive(rest);
    case 'c':
    case 's':
      return continue_at(rest, packet.front() == 's');
    case 'C':
    case 'S': {  // with a signal, which the chip ignores
      const auto address = rest.find(';');
      return continue_at(address == rest.npos ? "" : rest.substr(address + 1),
                         packet.front() == 'S');
    }
    case 'D':
      target_.clear_all();
      return std::string(ok);
    case 'k':
      killed_ = true;
      return {};
    case 'q':
    case 'Q':
    case 'v':
      return query(packet);
    default:
      return {};
  }
}

std::string Stub::query(std::string_view packet) {
  if (take(packet, "qSupported")) return supported(packet);
  if (take(packet, "qXfer:")) return transfer(packet);
  if (take(packet, "qRcmd,")) return monitor(packet);
  if (take(packet, "qThreadExtraInfo,")) return thread_info(packet);
  if (take(packet, "vFlash")) return flash(packet);
  if (packet == "QStartNoAckMode") return std::string(ok);
  if (packet == "qC") return "QC" + std::to_string(general_core_ + 1);
  if (packet == "qfThreadInfo") return "m1,2";
  if (packet == "qsThreadInfo") return "l";
  if (packet == "qAttached") return "1";
  if (packet == "vCont?") return "vCont;c;C;s;S";
  if (take(packet, "vCont")) return continue_some(packet);
  if (take(packet, "vKill")) {
    killed_ = true;
    packets_.send(ok);
  }
  return {};
}

std::string Stub::supported(std::string_view features) {
  swbreak_ = features.find("swbreak+") != features.npos;
  hwbreak_ = features.find("hwbreak+") != features.npos;
  return "PacketSize=" + number(Packets::max_size) +
         ";qXfer:features:read+;qXfer:memory-map:read+;QStartNoAckMode+;swbreak+;hwbreak+;"
         "vContSupported+";
}

/// A piece of one of the documents: "features:read:target.xml:offset,length".
std::string Stub::transfer(std::string_view request) {
  std::string document;
  if (take(request, "features:read:target.xml:"))
    document = target_description();
  else if (take(request, "memory-map:read::"))
    document = memory_map(static_cast<std::uint32_t>(target_.chip().flash().storage().size()));
  else
    return {};
  const auto place = take_pair(request);
  if (!place) return std::string(malformed);
  const std::size_t first = std::min<std::size_t>(place->first, document.size());
  const std::size_t size = std::min<std::size_t>(place->second, Packets::max_size / 4);
  const std::string piece = document.substr(first, size);
  return (first + piece.size() < document.size() ? 'm' : 'l') + piece;
}

// --- Threads -------------------------------------------------------------------------------------

std::string Stub::select_thread(std::string_view rest) {
  if (rest.empty()) return std::string(malformed);
  const char operation = rest.front();
  rest.remove_prefix(1);
  const auto thread = take_thread(rest);
  if (!thread) return std::string(no_thread);
  if (*thread > 0) (operation == 'g' ? general_core_ : continue_core_) = *thread - 1;
  return std::string(ok);
}

std::string Stub::thread_alive(std::string_view rest) const {
  const auto thread = take_thread(rest);
  return std::string(thread && *thread > 0 ? ok : no_thread);
}

std::string Stub::thread_info(std::string_view rest) {
  const auto thread = take_thread(rest);
  if (!thread || *thread <= 0) return std::string(no_thread);
  const Core& core = target_.chip().core(*thread - 1);
  std::string text = "core " + std::to_string(*thread - 1);
  if (core.locked_up())
    text += ", locked up";
  else if (core.sleeping())
    text += ", asleep";
  if (core.exception() != 0) text += ", exception " + std::to_string(core.exception());
  return to_hex(text);
}

// --- Registers and memory ------------------------------------------------------------------------

std::string Stub::read_registers() {
  std::string text;
  for (unsigned i = 0; i < DebugTarget::register_count; ++i)
    text += word_hex(target_.reg(general_core_, i));
  return text;
}

std::string Stub::write_registers(std::string_view rest) {
  constexpr std::size_t digits = 8;
  std::array<std::uint32_t, DebugTarget::register_count> values{};
  if (rest.size() != digits * values.size()) return std::string(malformed);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = word_from_hex(rest.substr(digits * i, digits));
    if (!value) return std::string(malformed);
    values[i] = *value;
  }
  // The stack pointer in use is written last: it is also MSP or PSP, whose values may be older.
  for (unsigned i = DebugTarget::register_count; i-- > 0;)
    target_.set_reg(general_core_, i, values[i]);
  return std::string(ok);
}

std::string Stub::read_register(std::string_view rest) {
  const auto which = take_number(rest);
  if (!which || *which >= DebugTarget::register_count) return std::string(malformed);
  return word_hex(target_.reg(general_core_, *which));
}

std::string Stub::write_register(std::string_view rest) {
  const auto which = take_number(rest);
  if (!which || *which >= DebugTarget::register_count || !take(rest, "="))
    return std::string(malformed);
  const auto value = word_from_hex(rest);
  if (!value) return std::string(malformed);
  target_.set_reg(general_core_, *which, *value);
  return std::string(ok);
}

std::string Stub::read_memory(std::string_view rest) {
  const auto place = take_pair(rest);
  if (!place) return std::string(malformed);
  std::vector<std::uint8_t> bytes(std::min<std::size_t>(place->second, Packets::max_size / 2));
  bytes.resize(target_.read(general_core_, place->first, bytes));
  return bytes.empty() && place->second != 0 ? std::string(no_memory) : to_hex(bytes);
}

std::string Stub::write_memory(std::string_view rest, bool binary) {
  const auto place = take_pair(rest);
  if (!place || !take(rest, ":")) return std::string(malformed);
  const auto bytes = binary ? std::optional(std::string(rest)) : from_hex(rest);
  if (!bytes || bytes->size() != place->second) return std::string(malformed);
  const bool done = target_.write(general_core_, place->first, as_bytes(*bytes));
  return std::string(done ? ok : no_memory);
}

std::string Stub::flash(std::string_view packet) {
  if (packet == "Done") return std::string(ok);
  if (take(packet, "Erase:")) {
    const auto place = take_pair(packet);
    if (!place) return std::string(malformed);
    return std::string(target_.erase_flash(place->first, place->second) ? ok : no_memory);
  }
  if (!take(packet, "Write:")) return {};
  const auto address = take_number(packet);
  if (!address || !take(packet, ":")) return std::string(malformed);
  return std::string(target_.program_flash(*address, as_bytes(packet)) ? ok : no_memory);
}

/// "type,address,kind": 0 in software, 1 in hardware, 2 write, 3 read, 4 access.
std::string Stub::breakpoint(std::string_view packet, bool set) {
  const auto type = take_number(packet);
  if (!type || !take(packet, ",")) return std::string(malformed);
  const auto place = take_pair(packet);
  if (!place) return std::string(malformed);
  switch (*type) {
    case 0:
    case 1:
      if (set)
        target_.set_breakpoint(place->first, *type == 1);
      else
        target_.clear_breakpoint(place->first, *type == 1);
      return std::string(ok);
    case 2:
    case 3:
    case 4: {
      const WatchKind kind = *type == 2   ? WatchKind::write
                             : *type == 3 ? WatchKind::read
                                          : WatchKind::access;
      if (set)
        target_.set_watch(place->first, place->second, kind);
      else
        target_.clear_watch(place->first, place->second, kind);
      return std::string(ok);
    }
    default:
      return {};
  }
}

std::string Stub::monitor(std::string_view command) {
  const auto text = from_hex(command);
  if (!text) return std::string(malformed);
  const auto wheel = [this]() -> TimeWheel& { return target_.chip().wheel(); };
  if (*text == "reset") {
    target_.reset();
    stop_ = {};
    return std::string(ok);
  }
  if (*text == "time") {
    const auto now = static_cast<std::uint64_t>(target_.chip().time());
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), "%llu.%012llu s, cycle %llu, clk_sys %llu Hz\n",
                  static_cast<unsigned long long>(now / ps_per_s),
                  static_cast<unsigned long long>(now % ps_per_s),
                  static_cast<unsigned long long>(wheel().now()),
                  static_cast<unsigned long long>(wheel().frequency()));
    return to_hex(std::string_view(line.data()));
  }
  return to_hex(std::string_view(
      "monitor reset: power-on reset\nmonitor time: simulated time and cycle of clk_sys\n"));
}

// --- Running -------------------------------------------------------------------------------------

/// ";action:thread;action": each core takes the first action that fits it.
std::string Stub::continue_some(std::string_view actions) {
  std::array<char, core_count> chosen{};
  while (take(actions, ";")) {
    const std::string_view whole = actions.substr(0, actions.find(';'));
    actions.remove_prefix(whole.size());
    if (whole.empty() || std::string_view("cCsS").find(whole.front()) == whole.npos)
      return std::string(malformed);
    int thread = -1;
    if (const auto colon = whole.find(':'); colon != whole.npos) {
      std::string_view name = whole.substr(colon + 1);
      const auto named = take_thread(name);
      if (!named) return std::string(no_thread);
      thread = *named == 0 ? -1 : *named;
    }
    const char action = whole.front() == 'C' ? 'c' : whole.front() == 'S' ? 's' : whole.front();
    for (int core = 0; core < core_count; ++core) {
      char& own = chosen[static_cast<std::size_t>(core)];
      if (own == 0 && (thread == -1 || thread == core + 1)) own = action;
    }
  }
  if (chosen[0] == 0 && chosen[1] == 0) return std::string(malformed);
  // If both are to be stepped, step the debugger's current core.
  int stepped = general_core_;
  if (chosen[static_cast<std::size_t>(stepped)] != 's') stepped = 1 - stepped;
  resume(chosen[static_cast<std::size_t>(stepped)] == 's', stepped);
  return {};
}

std::string Stub::continue_at(std::string_view rest, bool step) {
  if (!rest.empty()) {
    const auto address = take_number(rest);
    if (!address) return std::string(malformed);
    target_.set_reg(continue_core_, 15, *address);
  }
  resume(step, continue_core_);
  return {};
}

void Stub::resume(bool step, int core) {
  target_.resume(step ? std::optional(core) : std::nullopt);
  running_ = true;
}

void Stub::run(Cycle until) {
  const Stop stop = target_.run(until);
  if (stop.reason == Stop::Reason::none) return;
  halt(stop, signal_trap);
  packets_.send(stop_reply());
}

void Stub::halt(Stop stop, unsigned signal) {
  running_ = false;
  stop_ = stop;
  signal_ = signal;
  general_core_ = continue_core_ = stop.core;
}

std::string Stub::stop_reply() const {
  constexpr std::array<unsigned, 4> reported{13, 14, 15, 16};
  std::array<char, 8> head{};
  std::snprintf(head.data(), head.size(), "T%02x", signal_);
  std::string text = head.data();
  for (const unsigned each : reported)
    text += number(each) + ":" + word_hex(target_.reg(stop_.core, each)) + ";";
  text += "thread:" + std::to_string(stop_.core + 1) + ";";
  switch (stop_.reason) {
    case Stop::Reason::software_breakpoint:
      if (swbreak_) text += "swbreak:;";
      break;
    case Stop::Reason::hardware_breakpoint:
      if (hwbreak_) text += "hwbreak:;";
      break;
    case Stop::Reason::watch:
      text += stop_.kind == WatchKind::write  ? "watch:"
              : stop_.kind == WatchKind::read ? "rwatch:"
                                              : "awatch:";
      text += number(stop_.address) + ";";
      break;
    case Stop::Reason::none:
    case Stop::Reason::step:
      break;
  }
  return text;
}

}  // namespace lamplock::sim::chip::gdb
