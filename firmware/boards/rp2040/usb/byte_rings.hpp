// Rings of bytes between an interrupt and the main loop: what was received, what is to be sent.
//
// In:  ReceiveRing: packets (words of the USB buffer) or single bytes (UART) from the interrupt.
//      SendRing: bytes from the main loop.
// Out: the other way round. One writer and one reader each; indices only, no masking.
// Cost: copying a packet of 64 bytes takes 130 (aligned) to 250 cycles: words are shifted together,
//      never copied byte by byte.
//
// A full ReceiveRing drops what comes (the port must never make the host wait, or a hold would wait
// behind data) and keeps three promises: nothing is half-dropped unnoticed - a DEL stands where
// bytes are missing, which spoils the line or the CRC of the frame around it (shared/wire/
// framing.hpp), so that two halves of different lines are never one line; real-time bytes of what
// is dropped (hold, stop, ...) are kept, repeats of the same one once; what was dropped is counted.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/wire/framing.hpp"

namespace lamplock::rp2040 {

/// Orders memory accesses of the compiler; a single core needs no more.
inline void order_accesses() { std::atomic_signal_fence(std::memory_order_seq_cst); }

/// Stands where received bytes are missing.
inline constexpr std::uint8_t gap_mark = 0x7f;

/// What a ReceiveRing had to drop.
struct ReceiveLosses {
  std::uint32_t bytes = 0;
  std::uint32_t gaps = 0;
};

/// Received bytes.
template <std::uint32_t capacity>
class ReceiveRing {
  static_assert(capacity >= 256 && (capacity & (capacity - 1)) == 0, "positions wrap by masking");

 public:
  // Interrupt.

  /// Takes the first `size` (1 to 64) bytes of `words`, or drops them all.
  void push_packet(const volatile std::uint32_t* words, std::uint32_t size) {
    if (room() < reserve + margin + size) return drop_packet(words, size);
    if (gap_) end_gap();
    const std::uint32_t shift = 8 * (head_ % 4);
    const std::uint32_t count = (size + 3) / 4;
    const std::uint32_t index = head_ / 4 % word_count;
    const std::uint32_t first = std::min(count, word_count - index);  // up to the wrap
    std::uint32_t* const begin = words_.data();
    if (shift == 0) {
      copy(begin + index, words, first);
      copy(begin, words + first, count - first);
    } else {
      std::uint32_t carry = begin[index] & ((1u << shift) - 1);
      carry = merge(begin + index, words, first, shift, carry);
      carry = merge(begin, words + first, count - first, shift, carry);
      begin[(index + count) % word_count] = carry;
    }
    publish(head_ + size);
  }

  /// Takes one byte, or drops it.
  void push_byte(std::uint8_t byte) {
    if (room() < reserve + margin + 1) return drop_byte(byte);
    if (gap_) end_gap();
    append(byte);
  }

  /// Bytes were lost outside (overrun): the next byte comes behind a mark.
  void mark_gap() {
    if (!gap_) ++losses_.gaps;
    gap_ = true;
  }

  /// A new connection: what has not been read is void.
  void discard() {
    discard_to_ = head_;
    order_accesses();
    discard_ = true;
    gap_ = false;
    kept_ = 0;
  }

  // Main loop.

  /// Takes up to `out.size()` bytes; returns how many. None after a discard, so that who has looked
  /// whether the connection is a new one before this call never takes the first bytes of one.
  std::size_t pop(std::span<std::uint8_t> out) {
    if (discard_) {
      discard_ = false;
      order_accesses();
      tail_ = discard_to_;
      return 0;
    }
    const std::uint32_t tail = tail_;
    const std::size_t count = std::min<std::size_t>(out.size(), head_ - tail);
    order_accesses();
    for (std::uint32_t i = 0; i < count; ++i) out[i] = bytes()[(tail + i) % capacity];
    order_accesses();
    tail_ = tail + static_cast<std::uint32_t>(count);
    return count;
  }

  /// Bytes waiting.
  std::size_t size() const { return head_ - (discard_ ? discard_to_ : tail_); }
  const ReceiveLosses& losses() const { return losses_; }

 private:
  static constexpr std::uint32_t word_count = capacity / 4;
  /// Kept for real-time bytes of dropped packets.
  static constexpr std::uint32_t reserve = 64;
  /// One mark, and the whole words of a packet reach up to 7 bytes past its end.
  static constexpr std::uint32_t margin = 8;

  std::uint32_t room() const { return capacity - (head_ - tail_); }
  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(words_.data()); }

  static void copy(std::uint32_t* to, const volatile std::uint32_t* from, std::uint32_t count) {
    for (std::uint32_t* const end = to + count; to != end;) *to++ = *from++;
  }
  /// Copies words `shift` bits further up; `carry` fills the gap below, the rest is returned.
  static std::uint32_t merge(std::uint32_t* to, const volatile std::uint32_t* from,
                             std::uint32_t count, std::uint32_t shift, std::uint32_t carry) {
    const std::uint32_t back = 32 - shift;
    for (std::uint32_t* const end = to + count; to != end;) {
      const std::uint32_t word = *from++;
      *to++ = carry | word << shift;
      carry = word >> back;
    }
    return carry;
  }

  void publish(std::uint32_t head) {
    order_accesses();
    head_ = head;
  }
  void append(std::uint8_t byte) {
    bytes()[head_ % capacity] = byte;
    publish(head_ + 1);
  }
  void end_gap() {
    append(gap_mark);
    gap_ = false;
    kept_ = 0;
  }

  void drop_packet(const volatile std::uint32_t* words, std::uint32_t size) {
    mark_gap();
    losses_.bytes += size;
    for (std::uint32_t i = 0; i < size; i += 4) {
      std::uint32_t word = words[i / 4];
      for (std::uint32_t left = std::min<std::uint32_t>(size - i, 4); left != 0; --left) {
        const std::uint32_t byte = word & 0xff;
        if ((realtime_set[byte / 32] >> (byte % 32) & 1) != 0)
          keep(static_cast<std::uint8_t>(byte));
        word >>= 8;
      }
    }
  }
  void drop_byte(std::uint8_t byte) {
    mark_gap();
    ++losses_.bytes;
    if (wire::is_realtime(byte)) keep(byte);
  }
  /// A real-time byte of what is dropped; the same one again says nothing new.
  void keep(std::uint8_t byte) {
    if (byte != kept_ && room() <= margin) return;
    --losses_.bytes;
    if (byte == kept_) return;
    kept_ = byte;
    append(byte);
  }

  /// One bit a byte value: wire::is_realtime.
  static constexpr std::array<std::uint32_t, 8> realtime_set = [] {
    std::array<std::uint32_t, 8> set{};
    for (std::uint32_t byte = 0; byte < 256; ++byte)
      if (wire::is_realtime(static_cast<std::uint8_t>(byte))) set[byte / 32] |= 1u << (byte % 32);
    return set;
  }();

  std::array<std::uint32_t, word_count> words_{};
  volatile std::uint32_t head_ = 0;
  volatile std::uint32_t tail_ = 0;
  volatile std::uint32_t discard_to_ = 0;
  volatile bool discard_ = false;
  bool gap_ = false;
  std::uint8_t kept_ = 0;  ///< last real-time byte kept in this gap
  ReceiveLosses losses_;
};

/// Bytes to send.
template <std::uint32_t capacity>
class SendRing {
  static_assert(capacity >= 256 && (capacity & (capacity - 1)) == 0, "positions wrap by masking");

 public:
  // Main loop.

  std::size_t room() const { return capacity - (head_ - tail_); }

  /// Copies as much of `in` as fits behind the end, not to be seen before `publish`.
  std::uint32_t place(std::span<const std::uint8_t> in) {
    const std::uint32_t count =
        static_cast<std::uint32_t>(std::min<std::size_t>(in.size(), room()));
    const std::uint32_t head = head_;
    for (std::uint32_t i = 0; i < count; ++i) bytes()[(head + i) % capacity] = in[i];
    order_accesses();
    return count;
  }
  void publish(std::uint32_t count) { head_ = head_ + count; }

  // Interrupt.

  std::uint32_t size() const { return head_ - tail_; }

  /// Takes the first `size` (at most `size()`) bytes as words; the last word is padded.
  void pop_packet(volatile std::uint32_t* words, std::uint32_t size) {
    const std::uint32_t tail = tail_;
    const std::uint32_t shift = 8 * (tail % 4);
    const std::uint32_t* from = words_.data() + tail / 4 % word_count;
    const std::uint32_t* const wrap = words_.data() + word_count;
    volatile std::uint32_t* const end = words + (size + 3) / 4;
    if (shift == 0) {
      while (words != end) {
        *words++ = *from++;
        if (from == wrap) from = words_.data();
      }
    } else {
      const std::uint32_t back = 32 - shift;
      std::uint32_t word = *from++;
      while (words != end) {
        if (from == wrap) from = words_.data();
        const std::uint32_t next = *from++;
        *words++ = word >> shift | next << back;
        word = next;
      }
    }
    order_accesses();
    tail_ = tail + size;
  }

  /// Takes one byte; only if `size()` is not 0.
  std::uint8_t pop_byte() {
    const std::uint32_t tail = tail_;
    const std::uint8_t byte = bytes()[tail % capacity];
    order_accesses();
    tail_ = tail + 1;
    return byte;
  }

  /// A new connection: what was not sent is void.
  void discard() { tail_ = head_; }

 private:
  static constexpr std::uint32_t word_count = capacity / 4;
  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(words_.data()); }

  std::array<std::uint32_t, word_count> words_{};
  volatile std::uint32_t head_ = 0;
  volatile std::uint32_t tail_ = 0;
};

}  // namespace lamplock::rp2040
