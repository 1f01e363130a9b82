// The four functions that the compiler may call at any time (GCC manual, "Standards": a
// freestanding environment provides memcpy, memmove, memset and memcmp). Words where both ends
// allow it: the Cortex-M0+ faults on unaligned ones.
#include <cstddef>
#include <cstdint>

namespace {

/// Four words at a time, which the compiler turns into one load and one store of several registers.
struct [[gnu::may_alias]] Quad {
  std::uint32_t word[4];
};
using Word [[gnu::may_alias]] = std::uint32_t;

}  // namespace

extern "C" {

// In assembler: 13 cycles for four words, some 40 for a call that copies as many. Forwards, so that
// `to` may also overlap `from` from below. The directives let a debugger unwind from its middle.
[[gnu::naked]] void* memcpy(void* /*to*/, const void* /*from*/, std::size_t /*size*/) {
  asm volatile(
      ".syntax unified\n"
      "mov r12, r0\n"
      "movs r3, r0\n"
      "orrs r3, r1\n"
      "lsls r3, r3, #30\n"
      "bne 5f\n"
      "subs r2, #16\n"
      "blo 2f\n"
      "push {r4, r5, r6}\n"
      ".cfi_def_cfa_offset 12\n"
      ".cfi_offset r4, -12\n"
      ".cfi_offset r5, -8\n"
      ".cfi_offset r6, -4\n"
      "1: ldmia r1!, {r3, r4, r5, r6}\n"
      "stmia r0!, {r3, r4, r5, r6}\n"
      "subs r2, #16\n"
      "bhs 1b\n"
      "pop {r4, r5, r6}\n"
      ".cfi_def_cfa_offset 0\n"
      ".cfi_restore r4\n"
      ".cfi_restore r5\n"
      ".cfi_restore r6\n"
      "2: adds r2, #12\n"  // words
      "blo 4f\n"
      "3: ldmia r1!, {r3}\n"
      "stmia r0!, {r3}\n"
      "subs r2, #4\n"
      "bhs 3b\n"
      "4: adds r2, #4\n"
      "5: subs r2, #1\n"  // bytes
      "blo 7f\n"
      "6: ldrb r3, [r1]\n"
      "strb r3, [r0]\n"
      "adds r0, #1\n"
      "adds r1, #1\n"
      "subs r2, #1\n"
      "bhs 6b\n"
      "7: mov r0, r12\n"
      "bx lr\n");
}

void* memmove(void* to, const void* from, std::size_t size) {
  auto* d = static_cast<unsigned char*>(to);
  const auto* s = static_cast<const unsigned char*>(from);
  if (d <= s || d >= s + size) {
    // Forwards is safe: every byte is read before it is overwritten.
    return memcpy(to, from, size);
  }
  d += size;
  s += size;
  while (size-- > 0) *--d = *--s;
  return to;
}

void* memset(void* to, int value, std::size_t size) {
  auto* d = static_cast<unsigned char*>(to);
  const auto byte = static_cast<unsigned char>(value);
  const std::uint32_t word = byte * 0x01010101u;
  for (; size > 0 && (reinterpret_cast<std::uintptr_t>(d) & 3) != 0; --size) *d++ = byte;
  for (; size >= sizeof(Quad); size -= sizeof(Quad), d += sizeof(Quad))
    *reinterpret_cast<Quad*>(d) = {{word, word, word, word}};
  for (; size >= 4; size -= 4, d += 4) *reinterpret_cast<Word*>(d) = word;
  while (size-- > 0) *d++ = byte;
  return to;
}

int memcmp(const void* left, const void* right, std::size_t size) {
  const auto* a = static_cast<const unsigned char*>(left);
  const auto* b = static_cast<const unsigned char*>(right);
  for (; size > 0; --size, ++a, ++b)
    if (*a != *b) return int{*a} - int{*b};
  return 0;
}
}
