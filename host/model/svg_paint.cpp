#include "host/model/svg_paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "host/model/svg_shapes.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using pugi::xml_node;

/// A colour in lower case without blanks.
std::string plain_colour(std::string_view text) {
  std::string plain;
  for (const char c : text) {
    if (c == ' ' || c == '\t') continue;
    plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return plain;
}

/// A number or a percentage, as the properties of opacity have it.
std::optional<double> part_of_one(std::string_view text) { return find_svg_length(text, 1, {}); }

/// The alpha of "rgba(...)", "#rrggbbaa" and their variants; 1 without one.
double alpha_of(std::string_view colour) {
  constexpr std::size_t short_alpha = 5, long_alpha = 9;  // "#rgba", "#rrggbbaa"
  if (colour.starts_with('#')) {
    if (colour.size() == short_alpha) return colour.back() == '0' ? 0 : 1;
    if (colour.size() == long_alpha) return colour.ends_with("00") ? 0 : 1;
    return 1;
  }
  const std::size_t open = colour.find('('), close = colour.rfind(')');
  if (open == std::string_view::npos || close == std::string_view::npos || close < open) return 1;
  const std::string_view arguments = colour.substr(open + 1, close - open - 1);
  const std::size_t slash = arguments.find('/');
  const auto commas = std::count(arguments.begin(), arguments.end(), ',');
  std::string_view alpha;
  if (slash != std::string_view::npos)
    alpha = arguments.substr(slash + 1);
  else if (commas == 3)
    alpha = arguments.substr(arguments.rfind(',') + 1);
  return alpha.empty() ? 1 : part_of_one(alpha).value_or(1);
}

/// True if a paint leaves a mark. `url(#id)` needs its element, or a colour after it.
bool is_visible_paint(std::string_view text, const SvgDocument& document) {
  if (text.starts_with("url(")) {
    const std::size_t end = text.find(')');
    if (document.find_url(text)) return true;
    text = end == std::string_view::npos ? std::string_view{} : trimmed(text.substr(end + 1));
    if (text.empty()) return false;
  }
  const std::string colour = plain_colour(text);
  return colour != "none" && colour != "transparent" && alpha_of(colour) > 0;
}

bool is_white(std::string_view text) {
  constexpr std::array<std::string_view, 6> white{
      "white", "#fff", "#ffffff", "rgb(255,255,255)", "rgb(100%,100%,100%)", "rgb(255255255)"};
  return std::find(white.begin(), white.end(), plain_colour(text)) != white.end();
}

/// The lengths of stroke-dasharray, an even number; empty for a solid or an invalid one.
std::vector<double> dashes_of(std::string_view text, const SvgUnits& units) {
  std::vector<double> lengths;
  double sum = 0;
  constexpr std::string_view separators = " ,\t";
  while (true) {
    const std::size_t begin = text.find_first_not_of(separators);
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::string_view one = text.substr(0, text.find_first_of(separators));
    const auto length = find_svg_length(one, svg_diagonal(units.port), units);
    if (!length || !(*length >= 0)) return {};
    lengths.push_back(*length);
    sum += *length;
    text.remove_prefix(one.size());
  }
  if (!(sum > 0) || !std::isfinite(sum)) return {};
  if (lengths.size() % 2 != 0) {
    const std::vector<double> once = lengths;
    lengths.insert(lengths.end(), once.begin(), once.end());
  }
  return lengths;
}

void inherit_stroke(const xml_node& node, const SvgUnits& units, const SvgDocument& document,
                    SvgPaint& paint) {
  const auto value = [&](const char* name) { return svg_value(node, name); };
  const double diagonal = svg_diagonal(units.port);
  if (const auto stroke = value("stroke"); !stroke.empty())
    paint.has_stroke = is_visible_paint(stroke, document);
  paint.stroke_opacity = part_of_one(value("stroke-opacity")).value_or(paint.stroke_opacity);
  paint.stroke_width =
      find_svg_length(value("stroke-width"), diagonal, units).value_or(paint.stroke_width);
  if (const auto dashes = value("stroke-dasharray"); !dashes.empty())
    paint.dashes = dashes_of(dashes, units);
  paint.dash_offset =
      find_svg_length(value("stroke-dashoffset"), diagonal, units).value_or(paint.dash_offset);
  if (const auto ends = value("stroke-linecap"); !ends.empty())
    paint.has_long_ends = ends == "round" || ends == "square";
}

}  // namespace

std::string_view svg_value(const xml_node& node, const char* name) {
  return trimmed(node.attribute(name).value());
}

void inherit_paint(const xml_node& node, const SvgUnits& units, const SvgDocument& document,
                   SvgPaint& paint) {
  const auto value = [&](const char* name) { return svg_value(node, name); };
  if (const auto visibility = value("visibility"); !visibility.empty())
    paint.is_visible = visibility != "hidden" && visibility != "collapse";
  if (const auto fill = value("fill"); !fill.empty()) {
    paint.has_fill = is_visible_paint(fill, document);
    paint.fill_is_white = is_white(fill);
    paint.fill_is_server = fill.starts_with("url(");
    paint.fill_is_default = false;
  }
  paint.fill_opacity = part_of_one(value("fill-opacity")).value_or(paint.fill_opacity);
  inherit_stroke(node, units, document, paint);
}

bool has_dashes(const xml_node& shape, const SvgPaint& paint) {
  const bool shows_edge = paint.shows_fill() && !paint.fill_is_default && !paint.fill_is_white &&
                          std::string_view(shape.name()) != "line";
  return !paint.dashes.empty() && paint.shows_stroke() && !shows_edge;
}

bool shows_filled_edge(const xml_node& shape, const SvgPaint& paint) {
  const bool is_on_white = paint.fill_is_white && paint.shows_stroke();
  return paint.shows_fill() && !is_on_white && !has_dashes(shape, paint);
}

bool is_not_rendered(const xml_node& node) {
  return svg_value(node, "display") == "none" ||
         part_of_one(svg_value(node, "opacity")).value_or(1) <= 0;
}

}  // namespace lamplock::model
