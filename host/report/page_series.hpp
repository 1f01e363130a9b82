// Data for the charts of a job's page: the beat of each point, shots over the job, distances of
// points.
//
// In:  the run of a job, or a predicted one. Out: numbers per point, and histograms.
// Who: page.cpp. Budget: a million points in 2 s, memory linear.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/report/report.hpp"

namespace lamplock::report {

/// Values of every point, in firing order.
struct PointBeats {
  /// There were shots, recorded or predicted; otherwise the lists are empty.
  bool known = false;
  std::vector<std::uint32_t> beat;  ///< of its last shot, from the first of the job; without a shot
                                    ///< that of the point before
  std::vector<std::uint8_t> missed;  ///< 1: fired less often than ordered
  std::vector<std::uint32_t> shots;  ///< beat of every shot
};

/// Works out the beats of points and shots.
PointBeats point_beats(const JobRun& run);

/// Number of values in bins of equal width.
struct Histogram {
  double from = 0;                    ///< begin of the first bin
  double bin = 0;                     ///< width; 0: no values
  std::vector<std::uint64_t> counts;  ///< the last bin has all larger values too
  bool open = false;                  ///< there are larger values in it
  double least = 0, median = 0;
  std::size_t values = 0;
};

/// Distances of points to their nearest neighbours, mm, of at most `most` points, evenly chosen.
Histogram spacing_histogram(const geometry::PointCloud& cloud, std::size_t most = 1'000'000);

/// Beats from each point to the next: bin n counts the moves of n beats.
Histogram beats_histogram(const PointBeats& beats);

/// Shots per beat over the course of a job.
struct Utilisation {
  double beats_per_bin = 0;
  std::vector<double> share;  ///< 0..1 (more only if a beat had several shots)
};
Utilisation utilisation_over_time(const PointBeats& beats, std::uint64_t total_beats);

}  // namespace lamplock::report
