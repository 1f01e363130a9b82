// A log of records in a few sectors of flash: the newest written record survives power cuts.
//
// In:  a flash by three functions (`SettingsFlash`), a buffer of whole pages, the format of the
//      records (`RecordFormat`), items to keep.
// Out: the items kept last; the number of rejected records.
// Who: a store (store.hpp), which interprets the items. Several logs may share one buffer: it is in
//      use only within begin() .. save(), and from load() until its items have been read.
//
// Records are whole pages, in sequence, each with a sequence number and a CRC; the valid record
// with the highest number counts. A change appends a record; when a sector is full the log
// continues at the start of the next one, which is erased right before. Sectors take turns, so that
// wear is even, and the record that counts is never in the sector being erased.
//
//   sector 0            sector 1            sector 2            sector 3
//   | 17 | 18 | ...     | 33 | 34 |blank..  | 1 | 2 | ...       | 9 | ...
//                               ^ next
//
// Power may fail at any moment. A torn record has a wrong CRC: the old one counts. A page that is
// not blank is never written, nor is a sector whose erase may be incomplete: an erase is always the
// first half of the write that needs it, and is repeated if no valid record resulted.
//
//   offset  size
//   0       4      magic
//   4       4      sequence number, from 1
//   8       2      number n of items that follow
//   10      2      the same, inverted
//   12      n s    items of s bytes
//   12+n s  4      CRC-32 of everything before
//   little-endian; the rest of the last page stays erased
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/wire/bytes.hpp"
#include "shared/wire/crc32.hpp"

namespace lamplock::settings {

/// Unit of programming and of erasing, the same for every serial NOR flash.
inline constexpr std::uint32_t flash_page = 256;
inline constexpr std::uint32_t flash_sector = 4096;
inline constexpr std::uint8_t flash_blank = 0xff;

/// Flash interface of a log. Offsets count from the start of its area.
///   sectors                  number of sectors, at least 2
///   read(offset, bytes)      any offset and size
///   erase(offset)            one sector: every byte becomes 0xff
///   program(offset, page)    one page: bits go from 1 to 0
template <class Flash>
concept SettingsFlash = requires(Flash& flash, std::uint32_t offset, std::span<std::uint8_t> out,
                                 std::span<const std::uint8_t, flash_page> page) {
  requires Flash::sectors >= 2;
  flash.read(offset, out);
  flash.erase(offset);
  flash.program(offset, page);
};

/// Contents of the records of a log.
struct RecordFormat {
  std::uint32_t magic = 0;
  std::uint32_t item = 1;  ///< bytes of an item
  std::uint32_t most = 0;  ///< items: a record of a later version may be longer than ours

  static constexpr std::uint32_t head = 12, tail = 4;
  constexpr std::uint32_t bytes_of(std::uint32_t count) const { return head + count * item + tail; }
  constexpr std::uint32_t pages_of(std::uint32_t count) const {
    return (bytes_of(count) + flash_page - 1) / flash_page;
  }
  /// Buffer size for the longest record: whole pages, at most a sector.
  constexpr std::uint32_t buffer_size() const { return pages_of(most) * flash_page; }
};

/// One log on one flash area.
template <SettingsFlash Flash>
class RecordLog {
 public:
  /// The buffer has at least format.buffer_size() bytes; all arguments must outlive the log.
  RecordLog(Flash& flash, std::span<std::uint8_t> buffer, const RecordFormat& format)
      : flash_(flash), record_(buffer), format_(format) {}

  /// Searches the whole area; true if a record was found: items() returns its items then.
  bool load() {
    newest_ = next_ = valid_ = rejected_ = 0;
    for (std::uint32_t offset = 0; offset < size; offset += classify_page(offset)) {
    }
    // A torn record may become readable: its number is not used again.
    used_ = newest_ + rejected_;
    if (newest_ == 0) return false;
    read_record(newest_offset_);
    find_room();
    return true;
  }
  /// Items of the record in the buffer.
  std::span<const std::uint8_t> items() const {
    return record_.subspan(RecordFormat::head, count_of_record() * format_.item);
  }

  /// The place for the items of the next record.
  std::span<std::uint8_t> begin() {
    std::fill(record_.begin(), record_.end(), flash_blank);
    return record_.subspan(RecordFormat::head, format_.most * format_.item);
  }
  /// Keeps `count` items, stored since begin(); false if writing failed: then the old ones still
  /// count. load() must have been called before. Nothing is written if they equal those kept last.
  bool save(std::uint32_t count) {
    put(8, static_cast<std::uint16_t>(count));
    put(10, static_cast<std::uint16_t>(~count));
    if (newest_ != 0 && same_as_newest(count)) return true;
    finish(count);
    const std::uint32_t pages = format_.pages_of(count);
    // If it cannot be read back, try the next page, and then the next sector.
    for (std::uint32_t attempt = 0; attempt < max_attempts && make_room(pages); ++attempt) {
      const std::uint32_t offset = next_;
      for (std::uint32_t i = 0; i < pages; ++i) program(offset, i);
      next_ += pages * flash_page;
      if (!reads_back(offset, pages)) continue;
      newest_ = used_;
      newest_offset_ = offset;
      return true;
    }
    return false;
  }

  /// Number of the record that counts; 0 = none.
  std::uint32_t sequence() const { return newest_; }
  /// Records that load() has found.
  std::uint32_t valid() const { return valid_; }
  /// Pages without a valid record.
  std::uint32_t rejected() const { return rejected_; }

 private:
  static constexpr std::uint32_t size = Flash::sectors * flash_sector;
  static constexpr std::uint32_t pages_a_sector = flash_sector / flash_page;
  static constexpr std::uint32_t max_attempts = Flash::sectors * pages_a_sector;
  /// Bytes that are compared at once.
  static constexpr std::uint32_t piece = 64;

  template <std::integral T>
  T get(std::uint32_t offset) const {
    wire::ByteReader in(record_.subspan(offset));
    return in.take<T>();
  }
  template <std::integral T>
  void put(std::uint32_t offset, T value) {
    wire::ByteWriter out(record_.subspan(offset));
    out.put(value);
  }
  std::uint32_t count_of_record() const { return get<std::uint16_t>(8); }
  std::uint32_t sequence_of_record() const { return get<std::uint32_t>(4); }

  /// Reads a possible record into the buffer; false if it is not valid.
  bool read_record(std::uint32_t offset) {
    constexpr std::uint32_t head = RecordFormat::head;
    flash_.read(offset, record_.first(head));
    const std::uint32_t count = count_of_record();
    if (get<std::uint32_t>(0) != format_.magic || (count ^ get<std::uint16_t>(10)) != 0xffff ||
        count > format_.most)
      return false;
    if (sequence_of_record() == 0) return false;
    // A record never crosses into the next sector.
    if (offset % flash_sector + format_.pages_of(count) * flash_page > flash_sector) return false;
    flash_.read(offset + head, record_.subspan(head, format_.bytes_of(count) - head));
    const std::uint32_t end = format_.bytes_of(count) - RecordFormat::tail;
    return wire::crc32(record_.first(end)) == get<std::uint32_t>(end);
  }

  /// Classifies the page at an offset; returns the distance to the next.
  std::uint32_t classify_page(std::uint32_t offset) {
    if (!read_record(offset)) {
      if (!blank(offset)) ++rejected_;
      return flash_page;
    }
    ++valid_;
    if (sequence_of_record() > newest_) {
      newest_ = sequence_of_record();
      newest_offset_ = offset;
    }
    return format_.pages_of(count_of_record()) * flash_page;
  }

  bool blank(std::uint32_t offset) {
    std::array<std::uint8_t, piece> part;
    for (std::uint32_t at = 0; at < flash_page; at += piece) {
      flash_.read(offset + at, part);
      if (!std::all_of(part.begin(), part.end(), [](auto b) { return b == flash_blank; }))
        return false;
    }
    return true;
  }

  /// Room is after the newest record, and after the last page of its sector that is not blank,
  /// which a torn write may have left. The record must be in the buffer.
  void find_room() {
    const std::uint32_t least = newest_offset_ + format_.pages_of(count_of_record()) * flash_page;
    next_ = newest_offset_ - newest_offset_ % flash_sector + flash_sector;
    while (next_ > least && blank(next_ - flash_page)) next_ -= flash_page;
  }

  /// Sets next_ to the place of a record of `pages` pages; erases the next sector if this one has
  /// no room. False if that would be the sector of the record that counts.
  bool make_room(std::uint32_t pages) {
    const std::uint32_t left = (size - next_) % flash_sector;
    if (left >= pages * flash_page) return true;
    const std::uint32_t sector = (next_ + left) % size;
    if (newest_ != 0 && sector == newest_offset_ - newest_offset_ % flash_sector) return false;
    flash_.erase(sector);
    next_ = sector;
    return true;
  }

  void program(std::uint32_t offset, std::uint32_t page) {
    flash_.program(offset + page * flash_page, std::span<const std::uint8_t, flash_page>(
                                                   &record_[page * flash_page], flash_page));
  }

  /// The buffer from `from` to `to` equals the flash at the offset.
  bool same(std::uint32_t offset, std::uint32_t from, std::uint32_t to) {
    std::array<std::uint8_t, piece> part;
    for (std::uint32_t at = from; at < to; at += piece) {
      const std::uint32_t n = std::min(piece, to - at);
      flash_.read(offset + at, std::span(part).first(n));
      if (!std::equal(part.begin(), part.begin() + n, &record_[at])) return false;
    }
    return true;
  }
  bool reads_back(std::uint32_t offset, std::uint32_t pages) {
    return same(offset, 0, pages * flash_page);
  }
  /// The record in the buffer has the items of the newest one.
  bool same_as_newest(std::uint32_t count) {
    return same(newest_offset_, 8, format_.bytes_of(count) - RecordFormat::tail);
  }

  /// Completes the record of the items in the buffer, with the next number.
  void finish(std::uint32_t count) {
    put(0, format_.magic);
    put(4, ++used_);
    const std::uint32_t end = format_.bytes_of(count) - RecordFormat::tail;
    put(end, wire::crc32(record_.first(end)));
  }

  Flash& flash_;
  const std::span<std::uint8_t> record_;
  const RecordFormat& format_;
  std::uint32_t valid_ = 0, rejected_ = 0;
  std::uint32_t newest_ = 0;         ///< sequence number of the record that counts, 0 = none
  std::uint32_t newest_offset_ = 0;  ///< its offset
  std::uint32_t used_ = 0;           ///< highest sequence number of any record
  std::uint32_t next_ = 0;  ///< offset of the next record; at the start of a sector: erase first
};

}  // namespace lamplock::settings
