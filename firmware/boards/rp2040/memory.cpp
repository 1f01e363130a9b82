// The four functions that the compiler may call at any time (GCC manual, "Standards": a
// freestanding environment provides memcpy, memmove, memset and memcmp). Words where both ends
// allow it: the Cortex-M0+ faults on unaligned ones.
#include <cstddef>
#include <cstdint>

namespace {

/// Four words at a time, which the compiler makes into one load and one store of many registers.
struct [[gnu::may_alias]] Quad {
  std::uint32_t word[4];
};
using Word [[gnu::may_alias]] = std::uint32_t;

bool word_aligned(const void* a, const void* b) {
  return ((reinterpret_cast<std::uintptr_t>(a) | reinterpret_cast<std::uintptr_t>(b)) & 3) == 0;
}

}  // namespace

extern "C" {

void* memcpy(void* to, const void* from, std::size_t size) {
  auto* d = static_cast<unsigned char*>(to);
  const auto* s = static_cast<const unsigned char*>(from);
  if (word_aligned(d, s)) {
    for (; size >= sizeof(Quad); size -= sizeof(Quad), d += sizeof(Quad), s += sizeof(Quad))
      *reinterpret_cast<Quad*>(d) = *reinterpret_cast<const Quad*>(s);
    for (; size >= 4; size -= 4, d += 4, s += 4)
      *reinterpret_cast<Word*>(d) = *reinterpret_cast<const Word*>(s);
  }
  while (size-- > 0) *d++ = *s++;
  return to;
}

void* memmove(void* to, const void* from, std::size_t size) {
  auto* d = static_cast<unsigned char*>(to);
  const auto* s = static_cast<const unsigned char*>(from);
  if (d <= s || d >= s + size) {
    // Forwards is safe: what is written has been read.
    if (word_aligned(d, s))
      for (; size >= 4; size -= 4, d += 4, s += 4)
        *reinterpret_cast<Word*>(d) = *reinterpret_cast<const Word*>(s);
    while (size-- > 0) *d++ = *s++;
    return to;
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
