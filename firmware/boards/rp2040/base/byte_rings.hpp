// Rings of bytes between an interrupt and the main loop: received bytes, and bytes to send.
//
// In:  ReceiveRing: packets (words of the USB buffer) or single bytes (UART) from the interrupt.
//      SendRing: bytes from the main loop.
// Out: the reverse. One writer and one reader each; indices only, no masking.
// Cost: copying a packet of 64 bytes takes 130 (aligned) to 250 cycles: words are shifted together,
//      never copied byte by byte. The search for real-time bytes takes some 500 more in text, three
//      times as long in frames; a packet that has one is copied by bytes, in some 1200.
//
// Real-time bytes never wait for lines: the ReceiveRing removes them on arrival and passes them to
// the main loop through a separate inbox. A reset (0x18) discards the bytes received before it and
// not yet read. The end of jogs (0x85, `!`, 0x84) leaves a mark: bytes before it are recognised
// when they are read, because the jogs among them are void.
//
// A ReceiveRing without room refuses a packet: the port keeps it, so that the controller makes the
// host wait (NAK), and offers it again; its real-time bytes have been handled by then. A UART
// cannot wait: single bytes that do not fit are dropped and counted, and a DEL marks the gap. It
// invalidates the line or the CRC of the frame around it (shared/wire/framing.hpp), so that halves
// of different lines never form one line.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/wire/realtime_inbox.hpp"

namespace lamplock::rp2040 {

/// Orders memory accesses of the compiler; a single core needs no more.
inline void order_accesses() { std::atomic_signal_fence(std::memory_order_seq_cst); }

/// Marks a gap in the received bytes.
inline constexpr std::uint8_t gap_mark = 0x7f;

/// Lost bytes of a UART.
struct ReceiveLosses {
  std::uint32_t bytes = 0;  ///< dropped for lack of room
  std::uint32_t gaps = 0;   ///< places where bytes are missing
};

/// True if one of four bytes is a real-time byte: frames escape them, so their packets have none.
constexpr bool has_realtime(std::uint32_t word) {
  constexpr std::uint32_t ones = 0x01010101, tops = 0x80808080;
  // 0x80 to 0xaf: the highest bit is set, the next one is not, nor both of the two after it.
  std::uint32_t found = word & ~(word << 1) & ~(word << 2 & word << 3);
  for (const std::uint32_t byte :
       {wire::byte_reset, wire::byte_hold, wire::byte_status, wire::byte_resume}) {
    // Classic test for a zero byte, exact about whether there is one.
    const std::uint32_t other = word ^ byte * ones;
    found |= (other - ones) & ~other;
  }
  return (found & tops) != 0;
}

/// In bit 5 of each byte: it is a real-time byte, or one that looks similar. Digits, upper case
/// letters, points, signs and line ends do not. Without constants: four bytes take some 25 cycles.
constexpr std::uint32_t near_realtime(std::uint32_t word) {
  const std::uint32_t bit4 = word << 1, bit3 = word << 2, bit2 = word << 3, bit0 = word << 5;
  const std::uint32_t bit6 = word >> 1, bit7 = word >> 2;
  // `?` and `~` have the bits 2 to 5; `!` has 5 and 0, but none of 2 to 4; reset has 4, but not
  // 5, 6.
  return (word & bit4 & bit3 & bit2) | (word & bit0 & ~(bit4 | bit3 | bit2)) |
         (bit4 & ~word & ~bit6) | bit7;
}
/// The bits of near_realtime() that count.
inline constexpr std::uint32_t near_realtime_mask = 0x20202020;

/// A loop of eight cycles a byte.
inline void copy_run(const std::uint8_t* from, std::size_t count, std::uint8_t* to) {
  for (const std::uint8_t* const end = from + count; from != end;) *to++ = *from++;
}

template <std::uint32_t capacity>
class ReceiveRing {
  static_assert(capacity >= 256 && (capacity & (capacity - 1)) == 0, "positions wrap by masking");

 public:
  // Interrupt.

  /// Puts the real-time bytes of a packet, the first `size` (1 to 64) bytes of `words`, into the
  /// inbox. True if a reset is among them: packets before it that wait are void.
  bool take_realtime(const volatile std::uint32_t* words, std::uint32_t size) {
    plain_ = is_plain(words, size) ? words : nullptr;
    if (plain_ != nullptr) return false;
    bool reset = false, jog_cancel = false;
    for (std::uint32_t i = 0; i < size; ++i) {
      if (i % 4 == 0 && !has_realtime(words[i / 4])) {
        i += 3;
        continue;
      }
      const std::uint8_t byte = byte_of(words, i);
      if (!wire::is_realtime(byte)) continue;
      take_realtime(byte);
      jog_cancel = wire::ends_jogs(byte) || (jog_cancel && byte != wire::byte_reset);
      reset = reset || byte == wire::byte_reset;
    }
    if (jog_cancel) ++jog_cancels_ahead_;
    return reset;
  }
  /// Takes the other bytes of the packet; false without room for them: offer it again. A packet
  /// that take_realtime() has seen last must not have changed.
  bool push_packet(const volatile std::uint32_t* words, std::uint32_t size) {
    if (room() < margin + size) return false;
    if (gap_) end_gap();
    if (words == plain_ || is_plain(words, size))
      copy_packet(words, size);
    else
      copy_bytes(words, size);
    if (jog_cancels_ahead_ != 0)
      jog_cancel_ = head_;
    else
      forget_old_jog_cancel();
    plain_ = nullptr;
    return true;
  }

  /// Takes one byte, or drops it.
  void push_byte(std::uint8_t byte) {
    if (wire::is_realtime(byte)) return take_realtime(byte);
    if (room() < margin + 1) {
      mark_gap();
      ++losses_.bytes;
      return;
    }
    if (gap_) end_gap();
    append(byte);
    forget_old_jog_cancel();
  }

  /// Bytes were lost outside (overrun): marks the gap before the next byte.
  void mark_gap() {
    if (!gap_) ++losses_.gaps;
    gap_ = true;
    lost_ = true;
  }
  /// Packets whose real-time bytes were handled are lost.
  void lose_packets() {
    jog_cancels_ahead_ = 0;
    mark_gap();
  }

  /// Discards unread bytes: of another connection, or before a reset.
  void discard() {
    discard_to_ = head_;
    order_accesses();
    discard_ = true;
    gap_ = false;
    lost_ = false;
    jog_cancels_ahead_ = 0;
  }

  // Main loop.

  /// Removes the oldest command of one byte; false if there is none. To be called before pop(): a
  /// reset acts before the lines after it.
  bool pop_realtime(std::uint8_t& byte) { return inbox_.pop(byte); }
  bool realtime_waits() const { return inbox_.waits(); }

  /// Removes up to `out.size()` bytes; returns how many. None after a discard, so that a caller
  /// that checked for a new connection before this call never gets the first bytes of one; none
  /// while a command waits, which acts before the bytes after it. Never bytes from before and after
  /// the end of jogs at once: see before_jog_cancel().
  std::size_t pop(std::span<std::uint8_t> out) {
    // Read first: bytes received later are for the next call.
    const std::uint32_t head = head_;
    order_accesses();
    if (discard_) {
      discard_ = false;
      order_accesses();
      tail_ = discard_to_;
      return 0;
    }
    if (inbox_.waits()) return 0;
    const std::uint32_t tail = tail_;
    const std::uint32_t before = jog_cancel_ - tail;
    before_jog_cancel_ = before != 0 && before <= capacity;
    const std::uint32_t waiting = std::min(head - tail, before_jog_cancel_ ? before : capacity);
    const std::size_t count = std::min<std::size_t>(out.size(), waiting);
    order_accesses();
    const std::uint8_t* from = bytes() + tail % capacity;
    const std::size_t to_wrap = capacity - tail % capacity, first = std::min(count, to_wrap);
    copy_run(from, first, out.data());
    copy_run(bytes(), count - first, out.data() + first);
    order_accesses();
    tail_ = tail + static_cast<std::uint32_t>(count);
    return count;
  }

  /// The bytes of the last pop() were received before the end of jogs.
  bool before_jog_cancel() const { return before_jog_cancel_; }
  /// There is room for any packet.
  bool has_room() const { return room() >= margin + 64; }
  /// Bytes waiting, without commands of one byte.
  std::size_t size() const { return head_ - (discard_ ? discard_to_ : tail_); }
  const ReceiveLosses& losses() const { return losses_; }
  /// True once after bytes were lost, unless there was a reset since.
  bool take_loss() {
    const bool lost = lost_;
    lost_ = false;
    return lost;
  }

 private:
  static constexpr std::uint32_t word_count = capacity / 4;
  /// One mark, and the whole words of a packet extend up to 7 bytes past its end.
  static constexpr std::uint32_t margin = 8;

  std::uint32_t room() const { return capacity - (head_ - tail_); }
  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(words_.data()); }

  static void copy(std::uint32_t* to, const volatile std::uint32_t* from, std::uint32_t count) {
    for (std::uint32_t* const end = to + count; to != end;) *to++ = *from++;
  }
  /// Copies words `shift` bits higher; `carry` fills the gap below, returns the rest.
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
  }

  void copy_packet(const volatile std::uint32_t* words, std::uint32_t size) {
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

  /// Positions wrap: a very old one would appear ahead some day.
  void forget_old_jog_cancel() {
    constexpr std::uint32_t far = 2 * capacity;
    if (head_ - jog_cancel_ > far) jog_cancel_ = head_ - far;
  }

  static bool is_plain(const volatile std::uint32_t* words, std::uint32_t size) {
    const volatile std::uint32_t* const end = words + (size + 3) / 4;
    std::uint32_t found = 0;
    for (const volatile std::uint32_t* at = words; at != end; ++at) found |= near_realtime(*at);
    if ((found & near_realtime_mask) == 0) return true;
    // A loop, because an algorithm with a function argument may call it through a pointer.
    for (; words != end; ++words) {
      if (has_realtime(*words)) return false;
    }
    return true;
  }
  static std::uint8_t byte_of(const volatile std::uint32_t* words, std::uint32_t i) {
    return static_cast<std::uint8_t>(words[i / 4] >> 8 * (i % 4));
  }
  /// Copies all bytes except real-time bytes, and none from before the last reset.
  void copy_bytes(const volatile std::uint32_t* words, std::uint32_t size) {
    std::uint32_t from = 0;
    for (std::uint32_t i = 0; i < size; ++i)
      if (byte_of(words, i) == wire::byte_reset) from = i + 1;
    std::uint32_t head = head_;
    bool jog_cancel = false;
    for (std::uint32_t i = from; i < size; ++i) {
      const std::uint8_t byte = byte_of(words, i);
      if (!wire::is_realtime(byte)) bytes()[head++ % capacity] = byte;
      if (!wire::ends_jogs(byte)) continue;
      jog_cancel_ = head;
      jog_cancel = true;
    }
    if (jog_cancel && jog_cancels_ahead_ != 0) --jog_cancels_ahead_;
    publish(head);
  }
  void take_realtime(std::uint8_t byte) {
    inbox_.push(byte);
    if (wire::ends_jogs(byte)) jog_cancel_ = head_;
    if (byte == wire::byte_reset) discard();
  }

  std::array<std::uint32_t, word_count> words_{};
  volatile std::uint32_t head_ = 0;
  volatile std::uint32_t tail_ = 0;
  volatile std::uint32_t discard_to_ = 0;
  volatile std::uint32_t jog_cancel_ = 0;  ///< position of the last end of jogs
  volatile bool discard_ = false;
  volatile bool lost_ = false;
  bool gap_ = false;
  std::uint8_t jog_cancels_ahead_ = 0;             ///< waiting packets that contain one
  bool before_jog_cancel_ = false;                 ///< of the last pop()
  const volatile std::uint32_t* plain_ = nullptr;  ///< a packet without real-time bytes
  wire::RealtimeInbox inbox_;
  ReceiveLosses losses_;
};

template <std::uint32_t capacity>
class SendRing {
  static_assert(capacity >= 256 && (capacity & (capacity - 1)) == 0, "positions wrap by masking");

 public:
  // Main loop.

  std::size_t room() const { return capacity - (head_ - tail_); }

  /// Copies as much of `in` as fits after the end, invisible before `publish`.
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

  /// Removes the first `size` (at most `size()`) bytes as words; the last word is padded.
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

  /// Removes one byte; only if `size()` is not 0.
  std::uint8_t pop_byte() {
    const std::uint32_t tail = tail_;
    const std::uint8_t byte = bytes()[tail % capacity];
    order_accesses();
    tail_ = tail + 1;
    return byte;
  }

  /// A new connection: discards unsent bytes.
  void discard() { tail_ = head_; }

 private:
  static constexpr std::uint32_t word_count = capacity / 4;
  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(words_.data()); }

  std::array<std::uint32_t, word_count> words_{};
  volatile std::uint32_t head_ = 0;
  volatile std::uint32_t tail_ = 0;
};

}  // namespace lamplock::rp2040
