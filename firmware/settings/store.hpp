// The settings store: values that survive power cuts, in a few sectors of flash.
//
// In:  a flash by three functions (`SettingsFlash`), values to keep.
// Out: the values kept last, or the defaults; how many records had to be rejected.
// Who: the board, from its main loop and only at rest: a write may erase a sector, 45-400 ms.
//
// A log. Records are whole pages, one behind the other, each with a sequence number and a CRC; the
// valid record with the highest number counts. A change appends a record; when a sector is full the
// log goes on at the begin of the next one, which is erased right before. Sectors take turns, so
// that wear is even, and the record that counts never stands in the sector being erased.
//
//   sector 0            sector 1            sector 2            sector 3
//   | 17 | 18 | ...     | 33 | 34 |blank..  | 1 | 2 | ...       | 9 | ...
//                               ^ next
//
// Power may fail at any moment. A torn record has a wrong CRC: the old one counts. A page that is
// not blank is never written to, and a sector is never written to whose erase may not have come to
// its end: an erase is always the first half of the write that needs it, and is done again if no
// valid record came of it.
//
// A record holds the settings that differ from their defaults, by number: settings that a later
// version adds or drops do no harm.
//
//   offset  size
//   0       4     magic
//   4       4     sequence number, from 1
//   8       2     number of settings that follow
//   10      2     the same, inverted
//   12      6 n   setting number, value in thousandths
//   12+6n   4     CRC-32 of everything before
//   little-endian; the rest of the last page stays erased
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/settings_table.hpp"
#include "shared/wire/bytes.hpp"
#include "shared/wire/crc32.hpp"

namespace lamplock::settings {

/// Unit of programming and of erasing: what every serial NOR flash has.
inline constexpr std::uint32_t flash_page = 256;
inline constexpr std::uint32_t flash_sector = 4096;
inline constexpr std::uint8_t flash_blank = 0xff;

/// What the store needs of a flash. Offsets count from the begin of its area.
///   sectors                  how many there are, at least 2
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

/// What reading the store found.
struct StoreCounters {
  std::uint32_t valid = 0;           ///< records
  std::uint32_t rejected = 0;        ///< pages that hold something else
  std::uint32_t unknown_values = 0;  ///< of the record that counts: no such setting, or its range
};

/// One store on one flash area.
template <SettingsFlash Flash>
class Store {
 public:
  explicit Store(Flash& flash) : flash_(flash) {}

  /// Looks through the whole area; returns the values kept last, or the defaults.
  Values load() {
    counters_ = {};
    newest_ = next_ = 0;
    for (std::uint32_t offset = 0; offset < size; offset += look_at(offset)) {
    }
    // A torn record may read well one day: no later one has its number.
    used_ = newest_ + counters_.rejected;
    Values values;
    if (newest_ == 0) return values;
    read_record(newest_offset_);
    find_room();
    take_values(values);
    return values;
  }

  /// Keeps values; false if the flash did not take them: then the old ones still count. load() must
  /// have been called before. Nothing is written if the values are those kept last.
  bool save(const Values& values) {
    const std::uint32_t count = compose(values);
    if (newest_ != 0 && same_as_newest(count)) return true;
    const std::uint32_t pages = pages_of(count);
    // If it does not read back, the next page may be better, and then the next sector.
    for (std::uint32_t attempt = 0; attempt < most_attempts && make_room(pages); ++attempt) {
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

  /// Some values were saved, ever.
  bool empty() const { return newest_ == 0; }
  /// Number of the record that counts; 0 = none.
  std::uint32_t sequence() const { return newest_; }
  const StoreCounters& counters() const { return counters_; }

 private:
  static constexpr std::uint32_t size = Flash::sectors * flash_sector;
  static constexpr std::uint32_t magic = 0x5354504c;  // "LPTS"
  static constexpr std::uint32_t head = 12, per_value = 6, tail = 4;
  static constexpr std::uint32_t pages_a_sector = flash_sector / flash_page;
  static constexpr std::uint32_t most_attempts = Flash::sectors * pages_a_sector;

  static constexpr std::uint32_t bytes_of(std::uint32_t count) {
    return head + count * per_value + tail;
  }
  static constexpr std::uint32_t pages_of(std::uint32_t count) {
    return (bytes_of(count) + flash_page - 1) / flash_page;
  }
  /// A record of a later version may be longer than ours can get.
  static constexpr std::uint32_t most_values = 2 * setting_count + 32;
  static constexpr std::uint32_t most_pages = pages_of(most_values);
  static_assert(most_pages <= pages_a_sector);

  std::uint32_t word(std::uint32_t offset) const {
    wire::ByteReader in(std::span<const std::uint8_t>(record_).subspan(offset));
    return in.take<std::uint32_t>();
  }
  std::uint32_t half_word(std::uint32_t offset) const {
    wire::ByteReader in(std::span<const std::uint8_t>(record_).subspan(offset));
    return in.take<std::uint16_t>();
  }
  std::uint32_t count_of_record() const { return half_word(8); }
  std::uint32_t sequence_of_record() const { return word(4); }

  /// Reads what may be a record into the buffer; false if it is none.
  bool read_record(std::uint32_t offset) {
    const std::span<std::uint8_t> all(record_);
    flash_.read(offset, all.first(head));
    const std::uint32_t count = count_of_record();
    if (word(0) != magic || (count ^ half_word(10)) != 0xffff || count > most_values) return false;
    if (sequence_of_record() == 0) return false;
    // A record never crosses into the next sector.
    if (offset % flash_sector + pages_of(count) * flash_page > flash_sector) return false;
    flash_.read(offset + head, all.subspan(head, bytes_of(count) - head));
    const std::uint32_t end = bytes_of(count) - tail;
    return wire::crc32(all.first(end)) == word(end);
  }

  /// Judges the page at an offset; returns how far to go on.
  std::uint32_t look_at(std::uint32_t offset) {
    if (!read_record(offset)) {
      if (!blank(offset)) ++counters_.rejected;
      return flash_page;
    }
    ++counters_.valid;
    if (sequence_of_record() > newest_) {
      newest_ = sequence_of_record();
      newest_offset_ = offset;
    }
    return pages_of(count_of_record()) * flash_page;
  }

  bool blank(std::uint32_t offset) {
    std::array<std::uint8_t, 64> part;
    for (std::uint32_t at = 0; at < flash_page; at += part.size()) {
      flash_.read(offset + at, part);
      if (!std::all_of(part.begin(), part.end(), [](auto b) { return b == flash_blank; }))
        return false;
    }
    return true;
  }

  /// Room is behind the newest record, and behind the last page of its sector that is not blank: a
  /// torn write may have left something there. Expects the record in the buffer.
  void find_room() {
    const std::uint32_t least = newest_offset_ + pages_of(count_of_record()) * flash_page;
    next_ = newest_offset_ - newest_offset_ % flash_sector + flash_sector;
    while (next_ > least && blank(next_ - flash_page)) next_ -= flash_page;
  }

  /// Makes next_ the place of a record of so many pages; erases the next sector if this one has no
  /// room. False if that would be the sector of the record that counts.
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

  bool reads_back(std::uint32_t offset, std::uint32_t pages) {
    std::array<std::uint8_t, 64> part;
    for (std::uint32_t at = 0; at < pages * flash_page; at += part.size()) {
      flash_.read(offset + at, part);
      if (!std::equal(part.begin(), part.end(), &record_[at])) return false;
    }
    return true;
  }

  /// Makes a record of the settings that are not at their default; returns how many.
  std::uint32_t compose(const Values& values) {
    record_.fill(flash_blank);
    std::uint32_t count = 0;
    wire::ByteWriter body(std::span<std::uint8_t>(record_).subspan(head));
    for (std::size_t i = 0; i < setting_count; ++i) {
      const std::int32_t value = values.milli(static_cast<Id>(i));
      if (value == table[i].default_milli) continue;
      body.put(table[i].number);
      body.put(static_cast<std::uint32_t>(value));
      ++count;
    }
    wire::ByteWriter out(record_);
    out.put(magic);
    out.put(++used_);
    out.put(static_cast<std::uint16_t>(count));
    out.put(static_cast<std::uint16_t>(~count));
    const std::uint32_t end = bytes_of(count) - tail;
    body.put(wire::crc32(std::span<const std::uint8_t>(record_).first(end)));
    return count;
  }

  /// The record in the buffer has the values of the newest one.
  bool same_as_newest(std::uint32_t count) {
    std::array<std::uint8_t, 64> part;
    const std::uint32_t end = bytes_of(count) - tail;
    for (std::uint32_t at = 8; at < end; at += part.size()) {
      const std::uint32_t n = std::min<std::uint32_t>(part.size(), end - at);
      flash_.read(newest_offset_ + at, std::span(part).first(n));
      if (!std::equal(part.begin(), part.begin() + n, &record_[at])) return false;
    }
    return true;
  }

  void take_values(Values& values) {
    const std::uint32_t count = count_of_record();
    wire::ByteReader in(std::span<const std::uint8_t>(record_).subspan(head, count * per_value));
    for (std::uint32_t i = 0; i < count; ++i) {
      const Id id = find_number(in.take<std::uint16_t>());
      const auto value = static_cast<std::int32_t>(in.take<std::uint32_t>());
      if (id == Id::count || !values.set_milli(id, value)) ++counters_.unknown_values;
    }
  }

  Flash& flash_;
  std::array<std::uint8_t, most_pages * flash_page> record_{};
  StoreCounters counters_;
  std::uint32_t newest_ = 0;         ///< sequence number of the record that counts, 0 = none
  std::uint32_t newest_offset_ = 0;  ///< where it stands
  std::uint32_t used_ = 0;           ///< highest sequence number that any record may have
  std::uint32_t next_ = 0;           ///< where the next one goes; at a sector's begin: erase first
};

}  // namespace lamplock::settings
