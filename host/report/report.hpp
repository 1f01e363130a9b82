// Evaluates the run of a job.
//
// In:  the ordered points, in firing order; the shots recorded by the laser; the firmware's
// counters. Out: a Report (numbers); files.hpp writes it to files. Who: the command line after
// `engrave`; end-to-end tests.
//
// Missed and doubled points are counted from the shots fired, not from the firmware's counters:
// every shot is matched to a point. Shots have the order of the points except that a missed point
// may be fired later than its successors. So a shot belongs to the point after the one fired last
// if it hits that point, otherwise to any point that it hits, unfired ones first, otherwise (a
// wrong shot) to the nearest of the next few unfired points. A shot hits a point within the shot
// tolerance of the settings plus the rounding to steps.
//
// Shots of a real board are not recorded: unknown values are empty here and null in the file.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/glass/refraction.hpp"
#include "host/report/making.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"
#include "sim/world/shots.hpp"

namespace lamplock::report {

/// Faults of the link during a job.
struct LinkCounts {
  std::uint64_t resent = 0;
  std::uint64_t bad = 0;
  std::uint64_t reconnects = 0;
};

/// Results of the photosensors.
struct ShotChecks {
  std::uint64_t made = 0;
  std::uint64_t not_made = 0;
  std::uint64_t repeats = 0;  ///< shots at a point whose last shot was not made
};

/// How and where a run ended. Numbers count points and pauses of the job, as --from does.
struct RunEnd {
  std::string name;                  ///< "done", "stopped", ...; empty for an estimate
  std::uint64_t first_unfired = 0;   ///< all before it are done
  std::uint64_t may_have_fired = 0;  ///< none from here on was fired
  std::string continue_with;         ///< the command that continues the job; empty if it is done
  /// Pauses of the job before each of the two numbers: readers are shown the number of a point.
  std::uint64_t pauses_before = 0, pauses_before_end = 0;
};

/// Record of one run of a job.
struct JobRun {
  std::string input;  ///< file that was engraved
  std::string mode;   ///< "free", "start-stop"
  std::string board;  ///< "virtual" or the port
  Making making{};
  bool dry = false;  ///< the machine moved and fired nothing

  geometry::PointCloud points;               ///< in firing order, coordinates of the glass
  std::vector<std::uint16_t> shots_ordered;  ///< per point; empty: one each

  bool shots_known = true;  ///< false on a real board: the shots were not recorded
  /// The firmware's counters; used only if shots are unknown.
  std::uint64_t shots_fired = 0, points_fired = 0;
  std::vector<sim::Shot> shots;  ///< in order of time
  /// Machine position at the lattice tick of each shot's beat, same length as shots; empty:
  /// unknown.
  std::vector<StepPosition> lattice_steps;

  /// For a predicted run, instead of shots: the beat of each, from the first one.
  std::vector<std::uint32_t> foreseen_beats;

  std::size_t first_number = 0;  ///< of the point or pause that the run began with, in the job
  geometry::PointCloud points_before{};  ///< of the job, before that; fired by an earlier run
  std::uint64_t flashes_per_point = 1;   ///< ordered, also of a dry run; the maximum
  std::uint64_t pause_beats = 0;         ///< of the longest pause
  RunEnd end{};
  /// The index of the first point that the job had not reached when it ended; empty: it reached
  /// all.
  std::optional<std::size_t> stopped_before{};
  /// For each pause of the run the index of the point after it, in order. Pauses are numbered in
  /// the job together with the points.
  std::vector<std::uint32_t> pauses;
  std::vector<std::string> warnings;  ///< about the points, one line each

  PerAxis<double> steps_per_mm{200, 200, 200, 200};
  glass::Refraction refraction{};  ///< converts steps of the stage to the glass

  /// Lamp periods from the first shot to the last, both included; of a dry run those of its motion.
  std::uint64_t beats = 0;
  std::uint64_t beats_before = 0;  ///< lamp periods before these
  double time_s = 0;               ///< machine time of `beats`
  std::map<std::string, std::uint64_t>
      beats_by_reason;  ///< every beat by its reason; their sum is `beats`
  /// The same for the beats before the first shot and after the last.
  std::map<std::string, std::uint64_t> beats_outside;
  ShotChecks checks;
  LinkCounts link;
  settings::Values settings;
};

/// Result of the evaluation.
struct Report {
  std::string version, input, mode, board;
  Making making;
  bool dry = false;                              ///< nothing was fired
  std::optional<std::array<double, 3>> size_mm;  ///< of the box round all points of the job
  double lamp_hz = 0;
  std::uint64_t from = 0;           ///< number of the point or pause that the run began with
  std::uint64_t points_before = 0;  ///< points of the job before that
  std::uint64_t flashes_per_point = 1, pauses = 0, pause_beats = 0;
  RunEnd end{};
  std::uint64_t points = 0;        ///< ordered in this run
  std::uint64_t points_fired = 0;  ///< of these: as often as ordered
  std::uint64_t shots = 0;         ///< fired
  std::uint64_t beats = 0;
  std::uint64_t beats_before = 0;
  double beats_per_point = 0;  ///< fired; of a dry run: passed; without beats in which it was held
  double utilisation = 0;      ///< shots / beats, without those either
  double time_s = 0;
  double points_per_s = 0;  ///< fired; of a dry run: passed
  /// Largest over axes and shots of |steps at the lattice tick - wanted mm x steps per mm|.
  std::optional<double> max_error_steps;
  /// The same with the position at the real shot: lamp jitter included.
  std::optional<double> max_jitter_error_steps;
  std::optional<std::uint64_t> missed;   ///< points fired less often than ordered
  std::optional<std::uint64_t> doubled;  ///< shots beyond those ordered and their repeats
  std::map<std::string, std::uint64_t> beats_by_reason, beats_outside;
  ShotChecks checks;
  LinkCounts link;
  settings::Values settings;
};

/// Evaluates a run. Throws lamplock::Error if the lengths of its lists are inconsistent.
Report evaluate(const JobRun& run);

/// The index of the first point of a run that was not fired because the job had ended before it;
/// the number of points if there is none. A dry run fires no point.
std::size_t first_not_fired(const JobRun& run);

/// The number in the job of each point of a run, for --from. Points and pauses are counted
/// together, from 0.
std::vector<std::uint64_t> point_numbers(const JobRun& run);

/// The report as JSON text with the documented keys; settings by name in their unit.
std::string to_json(const Report& report);

}  // namespace lamplock::report
