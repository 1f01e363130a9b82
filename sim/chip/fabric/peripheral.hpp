// A block of registers on the APB or AHB-Lite bus of the simulated chip.
//
// The bus turns the atomic aliases into plain writes (RP2040 datasheet, 2.1.2: +0x1000 XOR, +0x2000
// set, +0x3000 clear) and widens narrow writes (2.1.4), so that a block sees whole words at offsets
// 0..0xffc. Before each call the bus has advanced time to the cycle of the access.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace lamplock::sim::chip {

class Peripheral {
 public:
  virtual ~Peripheral() = default;
  /// Name as in the datasheet, such as "TIMER".
  virtual std::string_view name() const = 0;
  /// A read with its side effects (FIFOs pop).
  virtual std::uint32_t read(std::uint32_t offset) = 0;
  /// The present value of the register, for atomic aliases and debuggers: no side effects, no
  /// report.
  virtual std::uint32_t peek(std::uint32_t offset) const = 0;
  virtual void write(std::uint32_t offset, std::uint32_t value) = 0;
  /// Bits that a written 1 clears. An alias passes them on as written instead of combining them
  /// with peek(): firmware clears such a bit through any alias but XOR. Every block must implement
  /// this, even to return 0: a missing bit would clear its neighbours as well.
  virtual std::uint32_t write_clear_bits(std::uint32_t offset) const = 0;
  /// Held in reset by RESETS: registers take their reset values.
  virtual void reset() = 0;
};

/// Called for an access to a register, a bit or a mode that is not modelled. The receiver reports
/// each text once; nothing is silently zero. Example: "PWM CH3_DIV written".
using NotModelled = std::function<void(const std::string& what)>;

}  // namespace lamplock::sim::chip
