#include "host/run/origin.hpp"

#include "host/link/operator.hpp"

namespace lamplock::run {

std::optional<geometry::Point> ask_origin(const std::string& name, link::Transport* port) {
  if (name == origin_machine) return std::nullopt;
  if (port == nullptr) return geometry::Point{};
  link::LinePort lines(*port);
  const link::Places places = link::ask_places(lines);
  link::require_unshifted(places);
  const auto axis = [&places](std::size_t a) {
    return a < places.zero.size() ? places.zero[a] : 0;
  };
  return geometry::Point{axis(0), axis(1), axis(2)};
}

}  // namespace lamplock::run
