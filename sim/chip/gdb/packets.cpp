#include "sim/chip/gdb/packets.hpp"

#include <utility>

namespace lamplock::sim::chip::gdb {

namespace {

constexpr std::uint8_t interrupt_byte = 0x03;
constexpr char escape = '}';
constexpr char escape_xor = 0x20;
constexpr std::string_view hex_digits = "0123456789abcdef";

unsigned sum(std::string_view bytes) {
  unsigned total = 0;
  for (const char each : bytes) total += static_cast<std::uint8_t>(each);
  return total & 0xff;
}

std::string resolve_escapes(std::string_view raw) {
  std::string payload;
  payload.reserve(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const bool escaped = raw[i] == escape && i + 1 < raw.size();
    payload += escaped ? static_cast<char>(raw[++i] ^ escape_xor) : raw[i];
  }
  return payload;
}

}  // namespace

void Packets::receive(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) receive_byte(byte);
}

std::optional<Packets::Received> Packets::next() {
  if (received_.empty()) return std::nullopt;
  Received first = std::move(received_.front());
  received_.pop_front();
  return first;
}

void Packets::receive_byte(std::uint8_t byte) {
  const char character = static_cast<char>(byte);
  if (state_ == State::outside) return receive_outside(byte);
  if (character == '$') {  // the rest of the packet before it was lost
    raw_.clear();
    state_ = State::payload;
    return;
  }
  switch (state_) {
    case State::payload:
      if (character == '#')
        state_ = State::first_digit;
      else if (raw_.size() < max_size)
        raw_ += character;
      else
        state_ = State::outside;
      break;
    case State::first_digit:
      // A wrong digit makes the checksum fail: no byte has the value 0x1000.
      checksum_digit_ = hex_digit(character).value_or(0x100);
      state_ = State::second_digit;
      break;
    case State::second_digit:
      state_ = State::outside;
      finish(checksum_digit_ << 4 | hex_digit(character).value_or(0x1000));
      break;
    case State::outside:
      break;
  }
}

void Packets::receive_outside(std::uint8_t byte) {
  if (byte == interrupt_byte) {
    received_.push_back({true, {}});
    return;
  }
  switch (static_cast<char>(byte)) {
    case '$':
      raw_.clear();
      state_ = State::payload;
      break;
    case '-':
      if (acknowledging_) output_ += last_;
      break;
    case '+':
      // Only a newly connected debugger sends an acknowledgement that is not needed.
      if (!std::exchange(last_acknowledgement_due_, false)) acknowledging_ = true;
      break;
    default:
      break;
  }
}

void Packets::finish(unsigned checksum) {
  const bool good = checksum == sum(raw_);
  if (acknowledging_) output_ += good ? '+' : '-';
  if (good) received_.push_back({false, resolve_escapes(raw_)});
}

void Packets::send(std::string_view payload) {
  std::string escaped;
  escaped.reserve(payload.size());
  for (const char each : payload) {
    // An asterisk would mean a run length.
    if (each == '$' || each == '#' || each == escape || each == '*') {
      escaped += escape;
      escaped += static_cast<char>(each ^ escape_xor);
    } else {
      escaped += each;
    }
  }
  const unsigned check = sum(escaped);
  last_ = '$' + escaped + '#' + hex_digits[check >> 4] + hex_digits[check & 15];
  output_ += last_;
}

void Packets::stop_acknowledging() {
  acknowledging_ = false;
  last_acknowledgement_due_ = true;
}

std::string Packets::take_output() { return std::exchange(output_, {}); }

std::optional<unsigned> hex_digit(char digit) {
  if (digit >= '0' && digit <= '9') return static_cast<unsigned>(digit - '0');
  if (digit >= 'a' && digit <= 'f') return static_cast<unsigned>(digit - 'a' + 10);
  if (digit >= 'A' && digit <= 'F') return static_cast<unsigned>(digit - 'A' + 10);
  return std::nullopt;
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::uint8_t byte : bytes) {
    text += hex_digits[byte >> 4];
    text += hex_digits[byte & 15u];
  }
  return text;
}

std::string to_hex(std::string_view bytes) {
  return to_hex(std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
}

std::optional<std::string> from_hex(std::string_view text) {
  if (text.size() % 2 != 0) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 2);
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const auto high = hex_digit(text[i]), low = hex_digit(text[i + 1]);
    if (!high || !low) return std::nullopt;
    bytes += static_cast<char>(*high << 4 | *low);
  }
  return bytes;
}

}  // namespace lamplock::sim::chip::gdb
