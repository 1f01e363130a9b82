// The edges of some pads, as far back as the script's expectations need them.
//
// In:  the pads. Out: edges in order, each with a permanent number.
// Who: the expectations of a script.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "sim/chip/chip.hpp"
#include "sim/chip/script/script_time.hpp"

namespace lamplock::sim::chip::script {

/// One change of a level.
struct PadEdge {
  Moment at;
  bool level = false;
  bool is(EdgeKind kind) const {
    return kind == EdgeKind::any || level == (kind == EdgeKind::rise);
  }
};

/// Listens to the pads from construction on; must live as long as the chip runs.
class PadLog final : private PadListener {
 public:
  /// `pins`: a bit for each pad of interest.
  PadLog(Chip& chip, std::uint32_t pins);
  PadLog(const PadLog&) = delete;
  PadLog& operator=(const PadLog&) = delete;

  /// Edges are numbered from 0; those before begin() have been dropped, end() is the next to
  /// happen.
  std::size_t begin(unsigned gpio) const { return pads_[gpio].dropped; }
  std::size_t end(unsigned gpio) const { return pads_[gpio].dropped + pads_[gpio].edges.size(); }
  const PadEdge& edge(unsigned gpio, std::size_t number) const {
    return pads_[gpio].edges[number - pads_[gpio].dropped];
  }
  /// The first edge later than a cycle.
  std::size_t first_after(unsigned gpio, Cycle cycle) const;
  /// The last edge of this kind up to and including a cycle, among those kept and the last dropped
  /// edge of each kind.
  std::optional<PadEdge> last(PinEdge of, Cycle cycle) const;
  /// Level before the edge with this number (which may be the next one to happen).
  bool level_before(unsigned gpio, std::size_t number) const {
    return number < end(gpio) ? !edge(gpio, number).level : pads_[gpio].level;
  }
  /// Drops edges before this cycle; they are not needed one by one any more. In any case at most a
  /// million edges of each pad are kept.
  void forget_before(Cycle cycle);
  /// True if edges after this cycle have been dropped.
  bool forgotten_after(unsigned gpio, Cycle cycle) const;

 private:
  struct Pad {
    std::deque<PadEdge> edges;
    std::size_t dropped = 0;
    std::array<std::optional<PadEdge>, 2> before{};  ///< the last fall and rise that were dropped
    bool level = false;
  };
  void pad_changed(unsigned gpio, bool level, Cycle at) override;

  Chip& chip_;
  std::uint32_t pins_;
  std::array<Pad, gpio_count> pads_{};
};

}  // namespace lamplock::sim::chip::script
