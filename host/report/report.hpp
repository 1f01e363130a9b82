// What a job did: the judge of a run.
//
// In:  the points as ordered, in firing order; what the laser recorded; the firmware's counters.
// Out: a Report (numbers); files.hpp writes it down.
// Who: the command line after `engrave`; end-to-end tests.
//
// Missed and doubled points come from what was really fired, not from the firmware's counters:
// every shot is matched to a point. Shots come in the order of the points except that a missed
// point may be fired later than its successors. So a shot belongs to the point after the one shot
// last if it lies there, else to any point that lies there, not fired ones first, else (a wrong
// shot) to the nearest of the next few points not fired. "Lies there" means within the shot
// tolerance of the settings plus the rounding to steps.
//
// On a real port nobody sees the shots: what cannot be known is empty here and null in the file.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/glass/refraction.hpp"
#include "host/points/point.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"
#include "sim/trace/shots.hpp"

namespace lamplock::report {

/// Troubles of the link during a job.
struct LinkCounts {
  std::uint64_t resent = 0;
  std::uint64_t bad = 0;
  std::uint64_t reconnects = 0;
};

/// What the photosensors said.
struct ShotChecks {
  std::uint64_t made = 0;
  std::uint64_t not_made = 0;
  std::uint64_t repeats = 0;  ///< shots at a point whose last shot was not made
};

/// Everything known about one run of a job.
struct JobRun {
  std::string input;  ///< file that was engraved
  std::string mode;   ///< "free", "start-stop"
  std::string board;  ///< "virtual" or the port

  points::PointCloud points;                 ///< in firing order, coordinates of the glass
  std::vector<std::uint16_t> shots_ordered;  ///< per point; empty: one each

  bool shots_known = true;  ///< false on a real board: nobody recorded the shots
  /// As the firmware counts; used only if shots are not known.
  std::uint64_t shots_fired = 0, points_fired = 0;
  std::vector<sim::Shot> shots;  ///< in order of time
  /// Machine position at the lattice tick of each shot's beat, same length as shots; empty:
  /// unknown.
  std::vector<StepPosition> lattice_steps;

  /// Instead of shots, of a run that is foreseen: the beat of each, from the first one.
  std::vector<std::uint32_t> foreseen_beats;

  std::size_t first_number = 0;  ///< of the point or pause that the run began with, in the job
  /// For each pause of the run the index of the point behind it, in order. A pause has a number in
  /// the job as a point has.
  std::vector<std::uint32_t> pauses;
  std::vector<std::string> warnings;  ///< about the points, one line each

  PerAxis<double> steps_per_mm{200, 200, 200, 200};
  glass::Refraction refraction{};  ///< from the steps of the stage into the glass

  std::uint64_t beats = 0;         ///< lamp periods from the first shot to the last, both included
  std::uint64_t beats_before = 0;  ///< lamp periods before the first shot
  double time_s = 0;               ///< machine time of `beats`
  std::map<std::string, std::uint64_t>
      beats_by_reason;  ///< every beat by its reason; their sum is `beats`
  /// The same of the beats before the first shot and after the last.
  std::map<std::string, std::uint64_t> beats_outside;
  ShotChecks checks;
  LinkCounts link;
  settings::Values settings;
};

/// The judgement.
struct Report {
  std::string version, input, mode, board;
  double lamp_hz = 0;
  std::uint64_t points = 0;        ///< ordered
  std::uint64_t points_fired = 0;  ///< of these: as often as ordered
  std::uint64_t shots = 0;         ///< fired
  std::uint64_t beats = 0;
  std::uint64_t beats_before = 0;
  double beats_per_point = 0;  ///< fired
  double utilisation = 0;      ///< shots / beats
  double time_s = 0;
  double points_per_s = 0;  ///< fired
  /// Largest over axes and shots of |steps at the lattice tick - wanted mm x steps per mm|.
  std::optional<double> largest_error_steps;
  /// The same with the position at the real shot: lamp jitter included.
  std::optional<double> largest_jitter_error_steps;
  std::optional<std::uint64_t> missed;   ///< points fired less often than ordered
  std::optional<std::uint64_t> doubled;  ///< shots beyond those ordered and their repeats
  std::map<std::string, std::uint64_t> beats_by_reason, beats_outside;
  ShotChecks checks;
  LinkCounts link;
  settings::Values settings;
};

/// Judges a run. Throws lamplock::Error if the run contradicts itself (lengths of the lists).
Report evaluate(const JobRun& run);

/// Of each point of a run its number in the job: where the job goes on with it (--from). Points
/// and pauses are counted together, from 0.
std::vector<std::uint64_t> point_numbers(const JobRun& run);

/// The report as JSON text, keys as documented; settings by name in their unit.
std::string to_json(const Report& report);

}  // namespace lamplock::report
