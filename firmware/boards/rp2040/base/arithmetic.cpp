// The divisions that the compiler calls, with the divider of the RP2040 (datasheet, 2.3.1.5).
//
// Names and registers: Run-time ABI for the Arm Architecture, "Integer division functions". The
// divider takes eight cycles and belongs to the core. An interrupt in between would destroy its
// state: no interrupt code divides, which toolchain/gate_image proves, so that masking or saving is
// not needed here. Interrupt code must not call these functions by another name. Divisors are not
// zero.
#include <cstdint>

#include "firmware/boards/rp2040/base/wide_division.hpp"
#include "firmware/boards/rp2040/registers/sio.hpp"

namespace lamplock::rp2040 {
namespace {

struct SioDivider {
  [[gnu::always_inline]] static Division divide(std::uint32_t n, std::uint32_t d) {
    sio().div_udividend = n;
    sio().div_udivisor = d;
    // Eight cycles in four branches.
    asm volatile("b 1f\n1: b 1f\n1: b 1f\n1: b 1f\n1:" ::: "memory");
    const std::uint32_t rest = sio().div_remainder;
    return {sio().div_quotient, rest};  // in this order: reading the quotient ends the division
  }
};

using Wide = WideDivision<SioDivider>;

constexpr std::uint64_t magnitude(std::int64_t x) {
  return x < 0 ? 0 - static_cast<std::uint64_t>(x) : static_cast<std::uint64_t>(x);
}
constexpr std::int64_t with_sign(std::uint64_t x, bool negative) {
  return static_cast<std::int64_t>(negative ? 0 - x : x);
}

}  // namespace
}  // namespace lamplock::rp2040

using namespace lamplock::rp2040;

extern "C" {

// The 32-bit ones entirely: dividend r0, divisor r1; quotient r0, remainder r1.
#define LAMPLOCK_DIVIDE_32(dividend)          \
  asm volatile(                               \
      ".syntax unified\n"                     \
      "movs r2, #0xd0\n"                      \
      "lsls r2, r2, #24\n"                    \
      "str r0, [r2, #" dividend               \
      "]\n"                                   \
      "str r1, [r2, #" dividend               \
      "+4]\n"                                 \
      "b 1f\n1: b 1f\n1: b 1f\n1: b 1f\n1:\n" \
      "ldr r1, [r2, #0x74]\n"                 \
      "ldr r0, [r2, #0x70]\n"                 \
      "bx lr\n")
static_assert(offsetof(SioRegisters, div_udividend) == 0x60);
static_assert(offsetof(SioRegisters, div_sdividend) == 0x68);
static_assert(offsetof(SioRegisters, div_quotient) == 0x70);

// The names are the ABI's.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
[[gnu::naked]] void __aeabi_uidivmod() { LAMPLOCK_DIVIDE_32("0x60"); }
[[gnu::naked]] void __aeabi_uidiv() { LAMPLOCK_DIVIDE_32("0x60"); }
[[gnu::naked]] void __aeabi_idivmod() { LAMPLOCK_DIVIDE_32("0x68"); }
[[gnu::naked]] void __aeabi_idiv() { LAMPLOCK_DIVIDE_32("0x68"); }
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

[[gnu::used]] std::uint64_t divide_unsigned_64(std::uint64_t n, std::uint64_t d,
                                               std::uint64_t& rest) {
  return Wide::divide(n, d, rest);
}

[[gnu::used]] std::int64_t divide_signed_64(std::int64_t n, std::int64_t d, std::int64_t& rest) {
  std::uint64_t left = 0;
  const std::uint64_t quotient = Wide::divide(magnitude(n), magnitude(d), left);
  rest = with_sign(left, n < 0);
  return with_sign(quotient, (n < 0) != (d < 0));
}

// Dividend r0 r1, divisor r2 r3; quotient r0 r1, remainder r2 r3, which no C++ function can return.
#define LAMPLOCK_DIVIDE_64(function) \
  asm volatile(                      \
      ".syntax unified\n"            \
      "push {r4, lr}\n"              \
      "sub sp, #16\n"                \
      "add r4, sp, #8\n"             \
      "str r4, [sp]\n"               \
      "bl " function                 \
      "\n"                           \
      "ldr r2, [sp, #8]\n"           \
      "ldr r3, [sp, #12]\n"          \
      "add sp, #16\n"                \
      "pop {r4, pc}\n")

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
[[gnu::naked]] void __aeabi_uldivmod() { LAMPLOCK_DIVIDE_64("divide_unsigned_64"); }
[[gnu::naked]] void __aeabi_ldivmod() { LAMPLOCK_DIVIDE_64("divide_signed_64"); }
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
}
