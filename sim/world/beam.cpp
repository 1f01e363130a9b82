#include "sim/world/beam.hpp"

#include <algorithm>

namespace lamplock::sim {
namespace {

/// The last of `list` at or before a time; the end if there is none.
template <class List>
auto last_before(const List& list, Picoseconds at) {
  const auto later =
      std::upper_bound(list.begin(), list.end(), at,
                       [](Picoseconds time, const auto& each) { return time < each.at; });
  return later == list.begin() ? list.end() : later - 1;
}

}  // namespace

Beam::Beam(PinBus& bus) {
  bus.listen(Pin::laser_gate, *this);
  bus.listen_to_power(*this);
}

void Beam::pin_changed(Pin /*pin*/, bool level, Picoseconds at) {
  gate_.push_back({at, level});
  if (level) ++openings_;
}

void Beam::power_changed(std::uint16_t power, Picoseconds at) { power_.push_back({at, power}); }

bool Beam::gate_at(Picoseconds at) const {
  const auto edge = last_before(gate_, at);
  return edge != gate_.end() && edge->level;
}

std::uint16_t Beam::power_at(Picoseconds at) const {
  const auto change = last_before(power_, at);
  return change == power_.end() ? std::uint16_t{0} : change->power;
}

BeamChange Beam::at(Picoseconds at) const { return {at, gate_at(at), power_at(at)}; }

std::vector<BeamChange> Beam::changes() const {
  std::vector<Picoseconds> times;
  if (gate_.empty()) return {};
  for (const GateEdge& edge : gate_) times.push_back(edge.at);
  for (const PowerChange& change : power_)
    if (change.at > gate_.front().at) times.push_back(change.at);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<BeamChange> changes;
  changes.reserve(times.size());
  for (const Picoseconds time : times) changes.push_back(at(time));
  return changes;
}

double Beam::energy(Picoseconds from, Picoseconds to) const {
  double sum = 0;
  BeamChange now = at(from);
  const auto until = [&](Picoseconds end) {
    if (end > now.at) sum += static_cast<double>(end - now.at) / ps_per_s * now.light() / 65'535.0;
  };
  for (const BeamChange& change : changes()) {
    if (change.at <= from) continue;
    if (change.at >= to) break;
    until(change.at);
    now = change;
  }
  until(to);
  return sum;
}

bool Beam::shone(Picoseconds from, Picoseconds to) const {
  if (from >= to) return false;
  if (at(from).shines()) return true;
  for (const BeamChange& change : changes())
    if (change.at > from && change.at < to && change.shines()) return true;
  return false;
}

}  // namespace lamplock::sim
