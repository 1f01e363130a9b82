// Data that the firmware needs before the first point: payload of BEGIN, head of a job file
// (docs/wire-format.md, section 3).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/result.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"
#include "shared/wire/bytes.hpp"
#include "shared/wire/messages.hpp"

namespace lamplock::wire {

/// All settings of the table that a job may override.
inline constexpr std::size_t max_overrides = settings::job_setting_count;

/// Speed of a job, percent of the speed that it was made for.
inline constexpr std::uint32_t full_job_speed = 100;
inline constexpr std::uint32_t max_job_speed = 140;

/// A setting that applies to this job only.
struct Override {
  std::uint16_t number = 0;
  std::int32_t value_milli = 0;
  friend constexpr bool operator==(const Override&, const Override&) = default;
};

/// Header of a job. `session` is sent in the frame header, the rest in the payload.
struct JobHeader {
  std::uint32_t session = 0;
  std::uint8_t axes = 3;
  std::uint8_t mode = 0;  ///< value of JoinMode, or mode_rows
  bool dry = false;       ///< move, never fire
  std::uint32_t points_total = 0;
  std::uint32_t first_index = 0;    ///< index of the first point that will be sent
  std::uint32_t settings_hash = 0;  ///< after the overrides; 0 = do not check
  StepPosition origin_steps{};      ///< reference of the first delta
  std::array<Override, max_overrides> overrides{};
  std::uint8_t override_count = 0;

  constexpr std::span<const Override> used_overrides() const {
    return std::span<const Override>(overrides).first(override_count);
  }
  friend constexpr bool operator==(const JobHeader&, const JobHeader&) = default;
};

inline constexpr std::size_t job_header_fixed_size = 34;
inline constexpr std::size_t override_size = 6;
inline constexpr std::size_t max_job_header_size =
    job_header_fixed_size + max_overrides * override_size;
static_assert(max_job_header_size <= max_payload);

/// Lines of pixels for a continuous laser (row_records.hpp); without a beat.
inline constexpr std::uint8_t mode_rows = 3;
inline constexpr std::uint8_t dry_flag = 1;

constexpr void write_job_header(ByteWriter& out, const JobHeader& header) {
  out.put(protocol_version);
  out.put(header.axes);
  out.put(header.mode);
  out.put(header.dry ? dry_flag : std::uint8_t{0});
  out.put(header.override_count);
  out.put(header.points_total);
  out.put(header.first_index);
  out.put(header.settings_hash);
  for (const std::int32_t steps : header.origin_steps) out.put(steps);
  for (const Override& item : header.used_overrides()) {
    out.put(item.number);
    out.put(item.value_milli);
  }
}

/// Reads and checks a payload. Sets all members but the session, only if ok.
constexpr Result read_job_header(std::span<const std::uint8_t> payload, JobHeader& header) {
  ByteReader in(payload);
  // The version is first in all versions: it defines the rest.
  const auto version = in.take<std::uint16_t>();
  if (!in.ok()) return Result::bad_frame;
  if (version != protocol_version) return Result::bad_version;
  JobHeader read;
  read.session = header.session;
  read.axes = in.take<std::uint8_t>();
  read.mode = in.take<std::uint8_t>();
  const auto flags = in.take<std::uint8_t>();
  read.dry = (flags & dry_flag) != 0;
  read.override_count = in.take<std::uint8_t>();
  read.points_total = in.take<std::uint32_t>();
  read.first_index = in.take<std::uint32_t>();
  read.settings_hash = in.take<std::uint32_t>();
  for (std::int32_t& steps : read.origin_steps) steps = in.take<std::int32_t>();
  if (!in.ok() || in.left() != read.override_count * override_size) return Result::bad_frame;
  if (read.override_count > max_overrides) return Result::bad_frame;
  for (std::size_t i = 0; i < read.override_count; ++i) {
    read.overrides[i].number = in.take<std::uint16_t>();
    read.overrides[i].value_milli = in.take<std::int32_t>();
  }
  if (read.axes < 1 || read.axes > max_axes || read.mode > mode_rows || (flags & ~dry_flag) != 0 ||
      read.first_index > read.points_total)
    return Result::bad_value;
  header = read;
  return Result::ok;
}

}  // namespace lamplock::wire
