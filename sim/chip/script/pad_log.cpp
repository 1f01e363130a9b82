#include "sim/chip/script/pad_log.hpp"

namespace lamplock::sim::chip::script {
namespace {
constexpr std::size_t max_edges = 1'000'000;
}  // namespace

PadLog::PadLog(Chip& chip, std::uint32_t pins) : chip_(chip), pins_(pins) {
  for (unsigned gpio = 0; gpio < gpio_count; ++gpio)
    pads_[gpio].level = (chip.gpio().pad_levels() >> gpio & 1u) != 0;
  chip.gpio().listen(static_cast<PadListener&>(*this));
}

void PadLog::pad_changed(unsigned gpio, bool level, Cycle at) {
  if ((pins_ >> gpio & 1u) == 0) return;
  pads_[gpio].level = level;
  pads_[gpio].edges.push_back({moment_of(chip_.wheel(), at), level});
}

std::size_t PadLog::first_after(unsigned gpio, Cycle cycle) const {
  const std::deque<PadEdge>& edges = pads_[gpio].edges;
  const auto first =
      std::upper_bound(edges.begin(), edges.end(), cycle,
                       [](Cycle at, const PadEdge& edge) { return at < edge.at.cycle; });
  return pads_[gpio].dropped + static_cast<std::size_t>(first - edges.begin());
}

std::optional<PadEdge> PadLog::last(PinEdge of, Cycle cycle) const {
  const Pad& pad = pads_[of.gpio];
  for (std::size_t number = first_after(of.gpio, cycle); number-- > pad.dropped;)
    if (edge(of.gpio, number).is(of.kind)) return edge(of.gpio, number);
  std::optional<PadEdge> result;
  for (const std::optional<PadEdge>& each : pad.before)
    if (each && each->is(of.kind) && (!result || each->at.cycle > result->at.cycle)) result = each;
  return result;
}

void PadLog::forget_before(Cycle cycle) {
  for (Pad& pad : pads_)
    while (!pad.edges.empty() &&
           (pad.edges.front().at.cycle < cycle || pad.edges.size() > max_edges)) {
      pad.before[pad.edges.front().level ? 1 : 0] = pad.edges.front();
      pad.edges.pop_front();
      ++pad.dropped;
    }
}

bool PadLog::forgotten_after(unsigned gpio, Cycle cycle) const {
  return std::any_of(pads_[gpio].before.begin(), pads_[gpio].before.end(),
                     [cycle](const auto& edge) { return edge && edge->at.cycle > cycle; });
}

}  // namespace lamplock::sim::chip::script
