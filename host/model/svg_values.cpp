#include "host/model/svg_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include "host/letter_case.hpp"
#include "host/model/text.hpp"

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
constexpr std::array<Transform, 11> transforms{{{"matrix", 6, 6},
                                                {"translate", 1, 2},
                                                {"translateX", 1, 1},
                                                {"translateY", 1, 1},
                                                {"scale", 1, 2},
                                                {"scaleX", 1, 1},
                                                {"scaleY", 1, 1},
                                                {"rotate", 1, 3},
                                                {"skew", 1, 2},
                                                {"skewX", 1, 1},
                                                {"skewY", 1, 1}}};

geometry::Affine map_of(std::string_view name, const std::vector<double>& a) {
  const auto second = [&](double otherwise) { return a.size() > 1 ? a[1] : otherwise; };
  const auto tangent = [&](double angle) { return std::tan(angle * std::numbers::pi / 180); };
  if (name == "matrix") return {{a[0], a[1], 0}, {a[2], a[3], 0}, {0, 0, 1}, {a[4], a[5], 0}};
  if (name == "translate") return geometry::moved(a[0], second(0), 0);
  if (name == "translateX") return geometry::moved(a[0], 0, 0);
  if (name == "translateY") return geometry::moved(0, a[0], 0);
  if (name == "scale") return geometry::scaled(a[0], second(a[0]), 1);
  if (name == "scaleX") return geometry::scaled(a[0], 1, 1);
  if (name == "scaleY") return geometry::scaled(1, a[0], 1);
  if (name == "skew") return {{1, tangent(second(0)), 0}, {tangent(a[0]), 1, 0}, {0, 0, 1}, {}};
  if (name == "skewX") return {{1, 0, 0}, {tangent(a[0]), 1, 0}, {0, 0, 1}, {}};
  if (name == "skewY") return {{1, tangent(a[0]), 0}, {0, 1, 0}, {0, 0, 1}, {}};
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
    place_.refuse(rest_.empty() ? "a number is missing at the end"
                                : fmt::format("a number is missing at '{:.20}'", rest_),
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

std::optional<double> find_svg_length(std::string_view text, double whole_px,
                                      const SvgUnits& units) {
  struct Unit {
    std::string_view name;
    double px;
  };
  constexpr double inch = 96, mm = inch / 25.4;
  const double width = units.page_width_px / 100, height = units.page_height_px / 100;
  // An x and a figure are half as high as wide in most fonts, which CSS suggests too.
  const double half_font = units.font_px / 2;
  const std::array<Unit, 18> known{{{"", 1},
                                    {"px", 1},
                                    {"mm", mm},
                                    {"cm", 10 * mm},
                                    {"in", inch},
                                    {"pt", inch / 72},
                                    {"pc", inch / 6},
                                    {"q", mm / 4},
                                    {"em", units.font_px},
                                    {"rem", units.root_font_px},
                                    {"ex", half_font},
                                    {"ch", half_font},
                                    {"vw", width},
                                    {"vh", height},
                                    {"vmin", std::min(width, height)},
                                    {"vmax", std::max(width, height)},
                                    {"%", whole_px / 100},
                                    {"ic", units.font_px}}};
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return std::nullopt;
  text = text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{} || !std::isfinite(value)) return std::nullopt;
  // "2em" is no number with an exponent: from_chars() leaves the letter.
  const std::string unit = in_lower_case({end, text.data() + text.size()});
  const auto* const found =
      std::find_if(known.begin(), known.end(), [&](const Unit& one) { return one.name == unit; });
  if (found == known.end()) return std::nullopt;
  return value * found->px;
}

double svg_length(std::string_view text, double whole_px, const SvgUnits& units,
                  const FilePosition& place) {
  if (const auto length = find_svg_length(text, whole_px, units)) return *length;
  if (has_decimal_comma(text))
    place.refuse(fmt::format("'{:.40}' has a decimal comma", text), write_decimal_points);
  place.refuse(fmt::format("'{:.40}' is not a length in a supported unit", text), "use mm or px");
}

double svg_font_size(std::string_view text, const SvgUnits& units) {
  struct Size {
    std::string_view name;
    double px;
  };
  // Sizes of browsers (HTML, "Rendering"); smaller and larger by one step of the scale.
  constexpr double step = 1.2;
  const std::array<Size, 9> named{{{"xx-small", 9},
                                   {"x-small", 10},
                                   {"small", 13},
                                   {"medium", 16},
                                   {"large", 18},
                                   {"x-large", 24},
                                   {"xx-large", 32},
                                   {"smaller", units.font_px / step},
                                   {"larger", units.font_px * step}}};
  for (const Size& size : named) {
    if (size.name == text) return size.px;
  }
  const auto length = find_svg_length(text, units.font_px, units);
  return length && *length >= 0 ? *length : units.font_px;
}

namespace {

/// Reads an argument of a transform, in px, degrees or without a unit.
double transform_argument(SvgScanner& scanner, const SvgUnits& units) {
  const double value = scanner.number();
  const std::string_view unit = scanner.rest().substr(
      0, static_cast<std::size_t>(
             std::find_if_not(scanner.rest().begin(), scanner.rest().end(), is_letter) -
             scanner.rest().begin()));
  if (unit.empty()) return value;
  scanner.word();
  if (unit == "deg") return value;
  if (unit == "rad") return value * 180 / std::numbers::pi;
  if (unit == "grad") return value * 0.9;
  if (unit == "turn") return value * 360;
  return value * svg_length(fmt::format("1{}", unit), 0, units, scanner.place());
}

}  // namespace

geometry::Affine svg_transform(std::string_view text, const SvgUnits& units,
                               const FilePosition& place) {
  geometry::Affine map;
  if (text == "none") return map;
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
      arguments.push_back(transform_argument(scanner, units));
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
