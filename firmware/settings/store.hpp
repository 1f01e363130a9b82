// Stores: values that survive power cuts, in a few sectors of flash.
//
// In:  a flash by three functions (`SettingsFlash`), values to keep.
// Out: the values kept last, or the defaults; the number of rejected records.
// Who: the board, from its main loop and only at rest: a write may erase a sector, 45-400 ms.
//
// A store is a log of records (record_log.hpp, which describes how it survives) and a type that
// defines their contents: the values and their conversion to items and back. The settings' type is
// here; the data that a program keeps have their own (machine/console/persistent_state.hpp), on
// separate sectors: so a failure of one cannot destroy the newest record of the other.
//
// A record of the settings contains those that differ from their defaults, by number: settings that
// a later version adds or drops do no harm. An item is 6 bytes, setting number and value in
// thousandths.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "firmware/settings/record_log.hpp"
#include "shared/settings_table.hpp"
#include "shared/wire/bytes.hpp"

namespace lamplock::settings {

/// Result of reading a store.
struct StoreCounters {
  std::uint32_t valid = 0;           ///< records
  std::uint32_t rejected = 0;        ///< pages without a valid record
  std::uint32_t unknown_values = 0;  ///< of the record that counts: unknown or out of range
};

/// Contents of the records of a store.
///   Value                the values; default-constructed it has the defaults
///   format               see RecordFormat
///   put(value, items)    writes the items of a value; returns their number
///   take(value, items)   applies items; returns how many are unknown or out of range
template <class Record>
concept StoredRecord = requires(typename Record::Value& value, std::span<std::uint8_t> out,
                                std::span<const std::uint8_t> in) {
  requires std::same_as<std::remove_cvref_t<decltype(Record::format)>, RecordFormat>;
  { Record::put(value, out) } -> std::same_as<std::uint32_t>;
  { Record::take(value, in) } -> std::same_as<std::uint32_t>;
};

/// One store on one flash area, with a buffer that others may use in between.
template <SettingsFlash Flash, StoredRecord Record>
class RecordStore {
 public:
  using Value = typename Record::Value;
  static constexpr std::uint32_t buffer_size = Record::format.buffer_size();
  static_assert(buffer_size <= flash_sector);

  /// Both must outlive the store; the buffer has at least buffer_size bytes.
  RecordStore(Flash& flash, std::span<std::uint8_t> buffer) : log_(flash, buffer, Record::format) {}

  /// Searches the whole area; returns the value kept last, or the defaults.
  void load(Value& value) {
    value = Value{};
    unknown_ = log_.load() ? Record::take(value, log_.items()) : 0;
  }
  Value load() {
    Value value;
    load(value);
    return value;
  }

  /// Keeps a value; false if writing failed: then the old one still counts. load() must have been
  /// called before. Nothing is written if the value equals the one kept last.
  bool save(const Value& value) { return log_.save(Record::put(value, log_.begin())); }

  /// No value was ever saved.
  bool empty() const { return log_.sequence() == 0; }
  /// Number of the record that counts; 0 = none.
  std::uint32_t sequence() const { return log_.sequence(); }
  StoreCounters counters() const { return {log_.valid(), log_.rejected(), unknown_}; }

 private:
  RecordLog<Flash> log_;
  std::uint32_t unknown_ = 0;
};

/// The settings that differ from their defaults.
struct SettingsRecord {
  using Value = Values;
  static constexpr std::uint32_t item_size = 6;
  static constexpr RecordFormat format{0x5354504c, item_size, 2 * setting_count + 14};  // "LPTS"

  static std::uint32_t put(const Values& values, std::span<std::uint8_t> items) {
    wire::ByteWriter out(items);
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < setting_count; ++i) {
      const std::int32_t value = values.milli(static_cast<Id>(i));
      if (value == ranges[i].default_milli) continue;
      out.put(numbers[i]);
      out.put(static_cast<std::uint32_t>(value));
      ++count;
    }
    return count;
  }
  static std::uint32_t take(Values& values, std::span<const std::uint8_t> items) {
    std::uint32_t unknown = 0;
    wire::ByteReader in(items);
    while (in.left() >= item_size) {
      const Id id = find_number(in.take<std::uint16_t>());
      const auto value = static_cast<std::int32_t>(in.take<std::uint32_t>());
      if (id == Id::count || !values.set_milli(id, value)) ++unknown;
    }
    return unknown;
  }
};

/// A buffer as a base class, so that it is constructed before its user.
struct SettingsBuffer {
  std::array<std::uint8_t, SettingsRecord::format.buffer_size()> bytes{};
};

/// The store of the settings with its own buffer.
template <SettingsFlash Flash>
class Store : private SettingsBuffer, public RecordStore<Flash, SettingsRecord> {
 public:
  explicit Store(Flash& flash) : RecordStore<Flash, SettingsRecord>(flash, SettingsBuffer::bytes) {}
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;
};

}  // namespace lamplock::settings
