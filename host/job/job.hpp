// A job: the targets or lines for the firmware, in steps.
//
// In:  a cloud of points [mm] in the order to engrave, in coordinates of the glass, a machine
//      profile, options. Jobs of rows of pixels are made by host/raster.
// Out: the header and the targets or lines; RecordEncoder cuts them into payloads for DATA frames,
//      beginning at any of them.
// Who: the command line makes jobs, the sender and the job file transport them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/glass/refraction.hpp"
#include "host/job/profile.hpp"
#include "host/job/rows.hpp"
#include "shared/settings_table.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/records.hpp"
#include "shared/wire/target.hpp"

namespace lamplock::job {

/// Options for making a job of points.
struct JobOptions {
  wire::JoinMode mode = wire::JoinMode::free;
  bool dry = false;             ///< move, never fire
  std::uint8_t shots = 1;       ///< flashes at each point
  std::uint8_t channel = 0;     ///< beam channel 0..3
  std::uint16_t energy = 0;     ///< 0 = keep the machine's current value
  bool check_settings = false;  ///< the machine refuses the job if any other setting differs
  /// Against heat: pause for `pause_beats` after every `pause_every` points. 0: never.
  std::size_t pause_every = 0;
  std::uint16_t pause_beats = 0;
  glass::Refraction refraction{};  ///< of the glass that the points are in
};

/// Header, and targets or rows. The header's first_index is 0; the sender can start at another one.
/// Targets are in coordinates of the stage. A pause is a target too: the machine and `--from` count
/// pauses with the points.
struct Job {
  wire::JobHeader header;
  std::vector<wire::Target> targets;
  Rows rows;
  settings::Values settings;       ///< the settings that the job was made for
  glass::Refraction refraction{};  ///< converts positions of the stage to the glass

  /// Rows of pixels instead of points.
  bool is_rows() const { return header.mode == wire::mode_rows; }
  /// Points at the beat of a lamp; not rows, nor points at a beat of the board's own.
  bool keeps_to_lamp() const;
  /// Targets or lines.
  std::size_t size() const { return is_rows() ? rows.lines.size() : targets.size(); }
  /// The word for one of them in messages.
  const char* item() const { return is_rows() ? "line" : "point"; }
  /// The target is a pause: some beats at the position of the target before it.
  bool is_pause(std::size_t target) const;
  /// Number of points among the targets before this one.
  std::size_t points_before(std::size_t target) const;
};

/// Makes a job: each coordinate is rounded to the nearest step of its axis. Throws
/// Error(bad_input) if there is no point, if there are too many pauses, or if points are outside
/// the work space (or not finite), with their number and index and coordinates of the first.
Job make_job(const geometry::PointCloud& points, const Profile& profile, const JobOptions& options);

/// The header of a job with this number of targets: the settings that the profile states, and the
/// geometry, are overrides.
wire::JobHeader make_header(const Profile& profile, const JobOptions& options, std::size_t targets);

/// Header for sending from target `first` on (first <= number of targets).
wire::JobHeader header_from(const Job& job, std::size_t first);

/// Applies the header's overrides to `base`. Throws Error(bad_input), at `where`, for a number that
/// is not in the table or a value out of range.
settings::Values apply_overrides(const settings::Values& base, const wire::JobHeader& header,
                                 const std::string& where = "job");

/// Cuts the targets or lines of a job into payloads, each to be decoded after the one before.
class RecordEncoder {
 public:
  /// Starts at target `first`, with the reference of header_from(job, first). The job must outlive
  /// the encoder.
  RecordEncoder(const Job& job, std::size_t first);

  /// The next payload: at most `max_bytes` bytes (at least wire::max_record_size) and
  /// `max_points` targets or lines; empty at the end of the job. Throws Error(bad_input) if two
  /// targets are further apart than 32 bits of steps.
  std::vector<std::uint8_t> next(std::size_t max_bytes, std::size_t max_points);

  /// Index after the last target or line encoded.
  std::size_t index() const { return index_; }
  /// Entries of the board's run table that all payloads so far need.
  std::uint64_t places() const { return rows_ ? rows_->places() : 0; }

 private:
  const Job* job_;
  std::size_t index_;
  std::optional<RowEncoder> rows_;
  wire::RecordState state_;
};

}  // namespace lamplock::job
