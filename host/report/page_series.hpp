// What the page of a job draws: where each point stands in time, how shots spread over the job, how
// near points are to each other.
//
// In:  the run of a job, or one that is foreseen. Out: numbers per point, and histograms.
// Who: page.cpp. Budget: a million points in 2 s, memory linear.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/report/report.hpp"

namespace lamplock::report {

/// Of every point, in order of firing.
struct PointBeats {
  bool known = false;               ///< somebody saw the shots, or foresees them; else all is empty
  std::vector<std::uint32_t> beat;  ///< of its last shot, from the first of the job; as the point
                                    ///< before if it had none
  std::vector<std::uint8_t> missed;  ///< 1: fired less often than ordered
  std::vector<std::uint32_t> shots;  ///< beat of every shot
};

/// Works out the beats of points and shots.
PointBeats point_beats(const JobRun& run);

/// How many values lie in bins of equal width.
struct Histogram {
  double from = 0;                    ///< where the first bin begins
  double bin = 0;                     ///< width; 0: there is nothing to count
  std::vector<std::uint64_t> counts;  ///< the last bin takes all larger values too
  double least = 0, median = 0;
  std::size_t values = 0;
};

/// Distances of points to their nearest neighbours, mm. Of more than `most` points only so many,
/// evenly chosen, are looked up (among all).
Histogram spacing_histogram(const points::PointCloud& cloud, std::size_t most = 1'000'000);

/// Beats from each point to the next: bin n counts the ways of n beats.
Histogram beats_histogram(const PointBeats& beats);

/// Shots per beat over the course of a job.
struct Utilisation {
  double beats_per_bin = 0;
  std::vector<double> share;  ///< 0..1 (more only if a beat had several shots)
};
Utilisation utilisation_over_time(const PointBeats& beats, std::uint64_t total_beats);

}  // namespace lamplock::report
