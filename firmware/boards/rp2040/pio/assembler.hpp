// An assembler for the programmable I/O blocks, run by the compiler (RP2040 datasheet, 3.3
// and 3.4).
//
// In:  typed instructions, labels, side-set, delays, wrap.
// Out: a Program: words with jump targets relative to its start, its length, where it wraps.
// Who: programs.hpp; everything is consteval, so the image contains only the words.
//
// A wrong operand does not compile: the call of an undefined function ends the constant expression,
// and its name states the error.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lamplock::rp2040::pio {

/// Instructions of one block, shared by its four state machines.
inline constexpr std::size_t block_size = 32;

/// A finished program.
struct Program {
  std::array<std::uint16_t, block_size> code{};
  std::uint8_t size = 0;
  std::uint8_t wrap_target = 0;  ///< where execution continues ...
  std::uint8_t wrap = 0;         ///< ... after this instruction
  std::uint8_t side_set_bits = 0;
  bool side_set_optional = false;

  /// Word for instruction memory if the program starts at `offset`: jumps are relocated.
  constexpr std::uint16_t at(std::size_t i, unsigned offset) const {
    const bool jump = (code[i] & 0xe000u) == 0;
    return static_cast<std::uint16_t>(code[i] + (jump ? offset : 0));
  }
};

enum class Jump : std::uint8_t {
  always,
  x_zero,
  x_nonzero_decrement,
  y_zero,
  y_nonzero_decrement,
  x_not_y,
  pin,
  osr_not_empty
};
enum class WaitFor : std::uint8_t { gpio, pin, irq };
enum class InFrom : std::uint8_t { pins = 0, x = 1, y = 2, null = 3, isr = 6, osr = 7 };
enum class OutTo : std::uint8_t {
  pins = 0,
  x = 1,
  y = 2,
  null = 3,
  pindirs = 4,
  pc = 5,
  isr = 6,
  exec = 7
};
enum class MoveTo : std::uint8_t { pins = 0, x = 1, y = 2, exec = 4, pc = 5, isr = 6, osr = 7 };
enum class MoveFrom : std::uint8_t {
  pins = 0,
  x = 1,
  y = 2,
  null = 3,
  status = 5,
  isr = 6,
  osr = 7
};
enum class Operation : std::uint8_t { copy = 0, invert = 1, reverse = 2 };
enum class SetTo : std::uint8_t { pins = 0, x = 1, y = 2, pindirs = 4 };

namespace error {
// Not defined: a call ends compilation and its name is the reason.
void program_longer_than_32_instructions();
void count_must_be_1_to_32();
void operand_must_be_0_to_31();
void irq_index_must_be_0_to_7();
void delay_too_long_for_side_set();
void side_set_value_too_wide();
void side_set_of_at_most_5_bits();
void side_set_missing();
void program_has_no_side_set();
void label_bound_twice();
void label_used_but_not_bound();
void too_many_labels();
}  // namespace error

/// Single instructions without side-set and delay, for the assembler and for immediate execution.
namespace encode {
consteval unsigned count(unsigned n) {
  if (n < 1 || n > 32) error::count_must_be_1_to_32();
  return n & 31;  // 32 is coded as 0
}
consteval unsigned operand(unsigned n) {
  if (n > 31) error::operand_must_be_0_to_31();
  return n;
}
consteval unsigned irq_index(unsigned n) {
  if (n > 7) error::irq_index_must_be_0_to_7();
  return n;
}
consteval std::uint16_t word(unsigned opcode, unsigned high, unsigned low) {
  return static_cast<std::uint16_t>(opcode << 13 | high << 5 | low);
}

constexpr std::uint16_t jump(Jump condition, unsigned address) {
  return static_cast<std::uint16_t>(static_cast<unsigned>(condition) << 5 | (address & 31));
}
consteval std::uint16_t wait(bool level, WaitFor source, unsigned index) {
  const unsigned i = source == WaitFor::irq ? irq_index(index) : operand(index);
  return word(1, unsigned{level} << 2 | static_cast<unsigned>(source), i);
}
consteval std::uint16_t in(InFrom from, unsigned bits) {
  return word(2, static_cast<unsigned>(from), count(bits));
}
consteval std::uint16_t out(OutTo to, unsigned bits) {
  return word(3, static_cast<unsigned>(to), count(bits));
}
consteval std::uint16_t push(bool if_full, bool block) {
  return word(4, unsigned{if_full} << 1 | unsigned{block}, 0);
}
consteval std::uint16_t pull(bool if_empty, bool block) {
  return word(4, 4 | unsigned{if_empty} << 1 | unsigned{block}, 0);
}
consteval std::uint16_t move(MoveTo to, MoveFrom from, Operation op = Operation::copy) {
  return word(5, static_cast<unsigned>(to),
              static_cast<unsigned>(op) << 3 | static_cast<unsigned>(from));
}
consteval std::uint16_t irq(bool clear, bool wait, unsigned index, bool relative = false) {
  return word(6, unsigned{clear} << 1 | unsigned{wait}, unsigned{relative} << 4 | irq_index(index));
}
consteval std::uint16_t set(SetTo to, unsigned value) {
  return word(7, static_cast<unsigned>(to), operand(value));
}
}  // namespace encode

/// A position in a program, possibly not known yet.
struct Label {
  std::uint8_t number = 0;
};

/// Builds one program.
class Assembler {
 public:
  /// `side_set_bits` pins are set by the side; if optional, one more bit marks whether.
  explicit consteval Assembler(unsigned side_set_bits = 0, bool optional = false)
      : side_bits_(side_set_bits), optional_(optional) {
    if (field_bits() > 5) error::side_set_of_at_most_5_bits();
    target_.fill(unbound);
    bound_.fill(unbound);
  }

  /// The last instruction: adds a side-set value and clocks of delay after it.
  class Last {
   public:
    consteval Last(Assembler& assembler, std::size_t at) : assembler_(assembler), at_(at) {}
    consteval Last side(unsigned value) const {
      assembler_.put_side(at_, value);
      return *this;
    }
    consteval Last delay(unsigned clocks) const {
      assembler_.put_delay(at_, clocks);
      return *this;
    }

   private:
    Assembler& assembler_;
    std::size_t at_;
  };

  consteval Label label() {
    if (labels_ == bound_.size()) error::too_many_labels();
    return {labels_++};
  }
  consteval void bind(Label label) {
    if (bound_[label.number] != unbound) error::label_bound_twice();
    bound_[label.number] = static_cast<std::uint8_t>(size_);
  }
  /// A label at this position.
  consteval Label here() {
    const Label l = label();
    bind(l);
    return l;
  }
  /// Execution wraps to the next instruction.
  consteval void wrap_target() { wrap_target_ = static_cast<std::uint8_t>(size_); }
  /// Execution wraps after the last instruction written.
  consteval void wrap() { wrap_ = static_cast<std::uint8_t>(size_ - 1); }

  consteval Last jump(Jump condition, Label target) {
    target_[size_] = target.number;
    return put(encode::jump(condition, 0));
  }
  consteval Last jump(Label target) { return jump(Jump::always, target); }
  consteval Last wait(bool level, WaitFor source, unsigned index) {
    return put(encode::wait(level, source, index));
  }
  consteval Last in(InFrom from, unsigned bits) { return put(encode::in(from, bits)); }
  consteval Last out(OutTo to, unsigned bits) { return put(encode::out(to, bits)); }
  consteval Last push(bool block = true) { return put(encode::push(false, block)); }
  consteval Last pull(bool block = true) { return put(encode::pull(false, block)); }
  consteval Last move(MoveTo to, MoveFrom from, Operation op = Operation::copy) {
    return put(encode::move(to, from, op));
  }
  consteval Last nop() { return move(MoveTo::y, MoveFrom::y); }
  consteval Last irq_set(unsigned index, bool relative = false) {
    return put(encode::irq(false, false, index, relative));
  }
  consteval Last irq_clear(unsigned index, bool relative = false) {
    return put(encode::irq(true, false, index, relative));
  }
  consteval Last set(SetTo to, unsigned value) { return put(encode::set(to, value)); }

  /// Checks and resolves; without wrap() the program wraps after its last instruction.
  consteval Program finish() const {
    Program p;
    p.size = static_cast<std::uint8_t>(size_);
    p.wrap_target = wrap_target_;
    p.wrap = wrap_ == unbound ? static_cast<std::uint8_t>(size_ - 1) : wrap_;
    p.side_set_bits = static_cast<std::uint8_t>(side_bits_);
    p.side_set_optional = optional_;
    for (std::size_t i = 0; i < size_; ++i) {
      if (side_bits_ != 0 && !optional_ && !side_given_[i]) error::side_set_missing();
      p.code[i] = code_[i];
      if (target_[i] == unbound) continue;
      if (bound_[target_[i]] == unbound) error::label_used_but_not_bound();
      p.code[i] = static_cast<std::uint16_t>(p.code[i] | bound_[target_[i]]);
    }
    return p;
  }
  /// Address of a bound label in the program.
  consteval std::uint8_t address(Label label) const { return bound_[label.number]; }

 private:
  static constexpr std::uint8_t unbound = 0xff;

  consteval unsigned field_bits() const { return side_bits_ + (optional_ ? 1 : 0); }
  consteval Last put(std::uint16_t word) {
    if (size_ == block_size) error::program_longer_than_32_instructions();
    code_[size_] = word;
    return {*this, size_++};
  }
  consteval void put_side(std::size_t at, unsigned value) {
    if (side_bits_ == 0) error::program_has_no_side_set();
    if (value >= 1u << side_bits_) error::side_set_value_too_wide();
    const unsigned enable = optional_ ? 1u << 12 : 0;
    code_[at] = static_cast<std::uint16_t>(code_[at] | enable | value << (13 - field_bits()));
    side_given_[at] = true;
  }
  consteval void put_delay(std::size_t at, unsigned clocks) {
    if (clocks >= 1u << (5 - field_bits())) error::delay_too_long_for_side_set();
    code_[at] = static_cast<std::uint16_t>(code_[at] | clocks << 8);
  }
  unsigned side_bits_;
  bool optional_;
  std::size_t size_ = 0;
  std::uint8_t labels_ = 0;
  std::uint8_t wrap_target_ = 0;
  std::uint8_t wrap_ = unbound;
  std::array<std::uint16_t, block_size> code_{};
  std::array<bool, block_size> side_given_{};
  std::array<std::uint8_t, block_size> target_{};
  std::array<std::uint8_t, block_size> bound_{};
};

}  // namespace lamplock::rp2040::pio
