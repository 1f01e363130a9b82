// A move of the plan as a writer of programs has written it: the lines that must make the machine
// go this way.
//
// Who: the writer (post.cpp); the check that compares a run of the program with the plan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "host/cutting/edge.hpp"

namespace lamplock::cutting {

struct WrittenMove {
  enum class Kind : std::uint8_t {
    rapid,   ///< to edge.to
    height,  ///< to z_mm; of a lathe to the radius edge.to.y
    sink,    ///< of a tool at edge.to with feed to z_mm
    cut      ///< along the edge
  };

  Kind kind = Kind::cut;
  bool is_arc = false;                       ///< of a cut: written as an arc; flat arcs are lines
  std::size_t first_line = 0, end_line = 0;  ///< of the program, from 1; the first one after it
  Edge edge;                   ///< of the plan, without the rounding of the program; mm
  std::optional<double> z_mm;  ///< at the end; none: the plan has no heights
  double feed_mm_min = 0;
  double s = 0;  ///< S word
};

}  // namespace lamplock::cutting
