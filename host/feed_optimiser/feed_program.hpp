// A program of lines and arcs with its feeds, before and after the optimisation.
//
// In:  blocks with the laser's power, and G-code between them. Out: the program with a feed for
//      each short piece, which a board runs; intermediate points as CSV.
// Who: `lamplock jerk`.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/feed_optimiser/optimise.hpp"

namespace lamplock::feed_optimiser {

/// The laser in blocks: "M5", "M3" or "M4"; empty: not part of the program.
struct Laser {
  std::string code{};
  double s = 0;
  friend bool operator==(const Laser&, const Laser&) = default;
};

/// Blocks with one setting of the laser.
struct Part {
  std::vector<std::string> lines_before{};
  Laser laser{};
  std::vector<Block> blocks{};
};

struct FeedProgram {
  std::optional<Point> start{};  ///< the place that is approached first, of a list of points
  std::vector<Part> parts{};
  std::vector<std::string> lines_after{};
  std::vector<std::string> remarks{};

  std::vector<Block> all_blocks() const;
};

/// "G0 X1.00000": the axes that have a place at the end of the block.
std::string rapid_line(const Block& block);

/// Joins straight blocks in each part.
void join_straight(FeedProgram& program, const Method& method);

/// The program as it is, of straight pieces and arcs, for the firmware's own plan. `origin` becomes
/// 0; blocks without a feed have `feed_mm_s`.
std::string plain_program(const FeedProgram& program, const Point& origin, double feed_mm_s);

/// The optimised program: G1 with a feed for each piece of at most `piece_s`. `optimised` are the
/// blocks of all_blocks(), in their order.
std::string optimised_program(const FeedProgram& program,
                              const std::vector<OptimisedBlock>& optimised, const Point& origin,
                              double piece_s);

/// The intermediate points as CSV in parts of one block each, the row of names first: all of them
/// may be some gigabytes.
void points_csv(const std::vector<OptimisedBlock>& optimised,
                const std::function<void(std::string_view)>& write);

}  // namespace lamplock::feed_optimiser
