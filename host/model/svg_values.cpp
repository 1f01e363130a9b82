#include "host/model/svg_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

namespace lamplock::model {
namespace {

constexpr std::string_view blanks = " \t\r\n\f";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A transform by name, with the minimum and maximum number of its arguments.
struct Transform {
  std::string_view name;
  std::size_t least, most;
};
constexpr std::array<Transform, 6> transforms{{{"matrix", 6, 6},
                                               {"translate", 1, 2},
                                               {"scale", 1, 2},
                                               {"rotate", 1, 3},
                                               {"skewX", 1, 1},
                                               {"skewY", 1, 1}}};

geometry::Affine map_of(std::string_view name, const std::vector<double>& a) {
  const auto second = [&](double otherwise) { return a.size() > 1 ? a[1] : otherwise; };
  const auto tangent = [&] { return std::tan(a[0] * std::numbers::pi / 180); };
  if (name == "matrix") return {{a[0], a[1], 0}, {a[2], a[3], 0}, {0, 0, 1}, {a[4], a[5], 0}};
  if (name == "translate") return geometry::moved(a[0], second(0), 0);
  if (name == "scale") return geometry::scaled(a[0], second(a[0]), 1);
  if (name == "skewX") return {{1, 0, 0}, {tangent(), 1, 0}, {0, 0, 1}, {}};
  if (name == "skewY") return {{1, tangent(), 0}, {0, 1, 0}, {0, 0, 1}, {}};
  const geometry::Affine turn = geometry::turned_about_z(a[0]);
  return a.size() == 3 ? geometry::moved(a[1], a[2], 0) * turn * geometry::moved(-a[1], -a[2], 0)
                       : turn;
}

}  // namespace

void SvgScanner::skip_blanks() {
  rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
}

void SvgScanner::skip_separator() {
  skip_blanks();
  if (!rest_.starts_with(',')) return;
  rest_.remove_prefix(1);
  skip_blanks();
}

bool SvgScanner::at_end() {
  skip_blanks();
  return rest_.empty();
}

bool SvgScanner::begins_number() {
  skip_separator();
  std::string_view text = rest_;
  if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
  if (text.starts_with('.')) text.remove_prefix(1);
  return !text.empty() && is_digit(text.front());
}

double SvgScanner::number() {
  if (!begins_number())
    place_.refuse(fmt::format("a number is missing at '{:.20}'", rest_),
                  "export the drawing again");
  const char* begin = rest_.data() + (rest_.starts_with('+') ? 1 : 0);
  double value = 0;
  const auto [end, failure] = std::from_chars(begin, rest_.data() + rest_.size(), value);
  if (failure != std::errc{} || !std::isfinite(value))
    place_.refuse(fmt::format("'{:.20}' is not a usable number", rest_),
                  "export the drawing again");
  rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
  return value;
}

bool SvgScanner::flag() {
  skip_separator();
  const char digit = take();
  if (digit != '0' && digit != '1')
    place_.refuse("the flag of an arc is neither 0 nor 1", "export the drawing again");
  return digit == '1';
}

char SvgScanner::take() {
  skip_blanks();
  if (rest_.empty()) return 0;
  const char c = rest_.front();
  rest_.remove_prefix(1);
  return c;
}

std::string_view SvgScanner::word() {
  skip_separator();
  const auto end = std::find_if_not(rest_.begin(), rest_.end(), is_letter);
  const std::string_view letters = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
  rest_.remove_prefix(letters.size());
  return letters;
}

std::vector<double> svg_numbers(std::string_view text, const FilePosition& place) {
  SvgScanner scanner(text, place);
  std::vector<double> numbers;
  while (!scanner.at_end()) numbers.push_back(scanner.number());
  return numbers;
}

double svg_length(std::string_view text, double whole_px, const FilePosition& place) {
  struct Unit {
    std::string_view name;
    double px;
  };
  constexpr double inch = 96, mm = inch / 25.4;
  constexpr std::array<Unit, 8> units{{{"", 1},
                                       {"px", 1},
                                       {"mm", mm},
                                       {"cm", 10 * mm},
                                       {"in", inch},
                                       {"pt", inch / 72},
                                       {"pc", inch / 6},
                                       {"Q", mm / 4}}};
  SvgScanner scanner(text, place);
  const double value = scanner.number();
  const std::string_view unit = scanner.rest().substr(
      0, scanner.rest().find_last_not_of(blanks) + 1);  // npos + 1 is 0: nothing but blanks
  if (unit == "%") return value / 100 * whole_px;
  for (const Unit& known : units) {
    if (known.name == unit) return value * known.px;
  }
  place.refuse(fmt::format("a length has the unsupported unit '{:.20}'", unit), "use mm or px");
}

geometry::Affine svg_transform(std::string_view text, const FilePosition& place) {
  geometry::Affine map;
  SvgScanner scanner(text, place);
  while (!scanner.at_end()) {
    const std::string_view name = scanner.word();
    const auto known = std::find_if(transforms.begin(), transforms.end(),
                                    [&](const Transform& t) { return t.name == name; });
    if (known == transforms.end() || scanner.take() != '(')
      place.refuse(fmt::format("the transform is not valid: '{:.40}'", text),
                   "export the drawing again");
    std::vector<double> arguments;
    while (scanner.begins_number() && arguments.size() < known->most)
      arguments.push_back(scanner.number());
    const bool centre_is_half = name == "rotate" && arguments.size() == 2;
    if (arguments.size() < known->least || centre_is_half || scanner.take() != ')')
      place.refuse(fmt::format("{} has the wrong arguments: '{:.40}'", name, text),
                   "export the drawing again");
    map = map * map_of(name, arguments);
    scanner.skip_separator();
  }
  return map;
}

geometry::Affine svg_fit(const SvgBox& view, const SvgBox& port, std::string_view aspect) {
  double x_scale = port.width / view.width, y_scale = port.height / view.height;
  const auto has = [&](std::string_view word) {
    return aspect.find(word) != std::string_view::npos;
  };
  double left = 0.5, top = 0.5;  // parts of the free space
  if (!has("none")) {
    x_scale = y_scale = has("slice") ? std::max(x_scale, y_scale) : std::min(x_scale, y_scale);
    left = has("xMin") ? 0 : has("xMax") ? 1 : 0.5;
    top = has("YMin") ? 0 : has("YMax") ? 1 : 0.5;
  }
  return geometry::moved(port.x + left * (port.width - view.width * x_scale),
                         port.y + top * (port.height - view.height * y_scale), 0) *
         geometry::scaled(x_scale, y_scale, 1) * geometry::moved(-view.x, -view.y, 0);
}

}  // namespace lamplock::model
