// The path of a program or of rows for pages: as many places as a page can draw, which keep its
// form.
//
// In:  a checked program, or a job of rows. Out: bytes for a page.
// Who: the method path.open.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"
#include "host/job/job.hpp"
#include "host/program/program_run.hpp"

namespace lamplock::serve {

/// The end of a straight piece.
struct PathPlace {
  geometry::Point place;  ///< mm of the machine
  double share = 0;       ///< of the lines of the file, 0 to 1, with the one that leads here
  bool is_rapid = false;  ///< the piece that leads here, or it is dark in a program with power
};

/// The first place is the begin. `sent`: the numbers in the file of the lines that are sent, in
/// order: a sender counts these.
std::vector<PathPlace> places_of(const program_run::ProgramRun& run,
                                 const std::vector<std::size_t>& sent);
/// The same for rows. The path begins at their first place, because rows store no place before it.
std::vector<PathPlace> places_of(const job::Job& rows);

class ShownPath {
 public:
  static constexpr std::size_t max_shown = 60'000;  ///< places that a page gets
  static constexpr std::size_t bytes_per_place = 8;

  /// Of more places than max_shown, those that are close together are one.
  explicit ShownPath(std::vector<PathPlace> places);

  std::size_t size() const { return places_.size(); }
  const std::vector<PathPlace>& places() const { return places_; }
  const geometry::Bounds& bounds() const { return bounds_; }
  /// For each place four 16-bit numbers, little endian: x, y and z from 0 to 65535 in the bounds;
  /// the share from 0 to 32767, doubled, and 1 more for a rapid.
  std::string bytes() const;

 private:
  std::vector<PathPlace> places_;
  geometry::Bounds bounds_;
};

}  // namespace lamplock::serve
