#include "host/glass/transformation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "host/error.hpp"
#include "host/model/transform.hpp"
#include "host/text.hpp"

namespace lamplock::glass {
namespace {

using geometry::Affine;
using geometry::Bounds;
using geometry::Point;

enum class Kind { map, centre, fit };

/// One parsed transformation. A map is about the origin until the middle is known.
struct Step {
  Kind kind = Kind::map;
  Affine map{};
  bool about_middle = false;
};

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const auto end = text.find_first_of(" \t,");
    words.push_back(text.substr(0, end));
    text.remove_prefix(std::min(words.back().size() + 1, text.size()));
  }
  return words;
}

/// All words as finite numbers; empty if one is no finite number.
std::optional<std::vector<double>> numbers_of(std::span<const std::string_view> words) {
  std::vector<double> numbers;
  for (const std::string_view word : words) {
    const auto number = number_of<double>(word);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<Point> axis_named(std::string_view word) {
  if (word == "x") return Point{1, 0, 0};
  if (word == "y") return Point{0, 1, 0};
  if (word == "z") return Point{0, 0, 1};
  return std::nullopt;
}

std::optional<Step> rotation(std::span<const std::string_view> words) {
  if (words.size() == 2) {
    const auto axis = axis_named(words[0]);
    const auto angle = numbers_of(words.subspan(1));
    if (!axis || !angle) return std::nullopt;
    return Step{Kind::map, model::turned_about(*axis, angle->front()), true};
  }
  const auto numbers = numbers_of(words);
  if (words.size() != 4 || !numbers) return std::nullopt;
  const Point axis{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  const double length = std::hypot(axis.x, axis.y, axis.z);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return Step{Kind::map, model::turned_about(axis, (*numbers)[3]), true};
}

std::optional<Step> scaling(std::span<const std::string_view> words) {
  const auto numbers = numbers_of(words);
  if (!numbers || (words.size() != 1 && words.size() != 3)) return std::nullopt;
  const auto positive = [](double factor) { return factor > 0; };
  if (!std::all_of(numbers->begin(), numbers->end(), positive)) return std::nullopt;
  const std::vector<double>& f = *numbers;
  return Step{Kind::map, geometry::scaled(f.front(), f[f.size() / 2], f.back()), true};
}

std::optional<Step> mirroring(std::span<const std::string_view> words) {
  if (words.size() != 1) return std::nullopt;
  const auto axis = axis_named(words[0]);
  if (!axis) return std::nullopt;
  return Step{Kind::map, geometry::scaled(1 - 2 * axis->x, 1 - 2 * axis->y, 1 - 2 * axis->z), true};
}

std::optional<Step> moving(std::span<const std::string_view> words) {
  const auto numbers = numbers_of(words);
  if (!numbers || words.size() != 3) return std::nullopt;
  return Step{Kind::map, geometry::moved((*numbers)[0], (*numbers)[1], (*numbers)[2]), false};
}

std::optional<Step> parse(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text);
  if (words.empty()) return std::nullopt;
  const std::span<const std::string_view> rest = std::span(words).subspan(1);
  if (words[0] == "move") return moving(rest);
  if (words[0] == "rotate") return rotation(rest);
  if (words[0] == "scale") return scaling(rest);
  if (words[0] == "mirror") return mirroring(rest);
  if (words[0] == "centre" && rest.empty()) return Step{Kind::centre};
  if (words[0] == "fit" && rest.empty()) return Step{Kind::fit};
  return std::nullopt;
}

Step read_step(const std::string& words, const std::string& where) {
  const std::optional<Step> step = parse(words);
  if (step) return *step;
  throw Error(Exit::bad_input, where, fmt::format("'{}' is not a transformation", words),
              "write move X Y Z, rotate AXIS DEG, scale F, mirror AXIS, centre or fit");
}

Affine centring(const Bounds& box, const Point& middle) {
  const Point at = box.centre();
  return geometry::moved(middle.x - at.x, middle.y - at.y, middle.z - at.z);
}

Affine fitting(const Bounds& box, const Bounds& room, const std::string& where) {
  const double factor = fitting_scale(box, room);
  if (!(factor > 0) || !std::isfinite(factor))
    throw Error(Exit::bad_input, where, "has no extent and cannot be fitted",
                "give a model of more than one point");
  return model::about(geometry::scaled(factor, factor, factor), room.centre()) *
         centring(box, room.centre());
}

/// The room less a margin on each side.
Bounds narrowed(Bounds room, const Point& margin, const std::string& where) {
  room.low = {room.low.x + margin.x, room.low.y + margin.y, room.low.z + margin.z};
  room.high = {room.high.x - margin.x, room.high.y - margin.y, room.high.z - margin.z};
  if (room.low.x > room.high.x || room.low.y > room.high.y || room.low.z > room.high.z)
    throw Error(Exit::bad_input, where, "has layers that are thicker together than the room",
                "use fewer layers, or a smaller distance between them");
  return room;
}

}  // namespace

void check_transformation(const std::string& words, const std::string& where) {
  read_step(words, where);
}

double fitting_scale(const Bounds& box, const Bounds& room) {
  double scale = std::numeric_limits<double>::infinity();
  const auto axis = [&scale](double side, double space) {
    if (side > 0) scale = std::min(scale, space / side);
  };
  axis(box.high.x - box.low.x, room.high.x - room.low.x);
  axis(box.high.y - box.low.y, room.high.y - room.low.y);
  axis(box.high.z - box.low.z, room.high.z - room.low.z);
  return scale;
}

Affine placement(const Affine& first, std::span<const std::string> transformations,
                 const Volume& volume, const BoxUnder& box_under, const std::string& where,
                 const MarginUnder& margin_under) {
  const Point middle = volume.middle();
  Affine map = first;
  for (const std::string& words : transformations) {
    const Step step = read_step(words, where);
    switch (step.kind) {
      case Kind::map:
        map = (step.about_middle ? model::about(step.map, middle) : step.map) * map;
        break;
      case Kind::centre:
        map = centring(box_under(map), middle) * map;
        break;
      case Kind::fit:
        map = fitting(box_under(map),
                      narrowed(volume.room(), margin_under ? margin_under(map) : Point{}, where),
                      where) *
              map;
        break;
    }
  }
  return map;
}

}  // namespace lamplock::glass
