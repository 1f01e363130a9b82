#include "host/model/svg_colour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <vector>

#include "host/letter_case.hpp"
#include "host/model/colour.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

/// Words for colours whose values are not in the table of named colours.
constexpr std::string_view other_names =
    " transparent currentcolor "
    // System colours of CSS, also those of CSS 2.
    "accentcolor accentcolortext activetext activeborder activecaption appworkspace background "
    "buttonborder buttonface buttonhighlight buttonshadow buttontext canvas canvastext captiontext "
    "field fieldtext graytext highlight highlighttext inactiveborder inactivecaption "
    "inactivecaptiontext infobackground infotext linktext mark marktext menu menutext scrollbar "
    "selecteditem selecteditemtext threeddarkshadow threedface threedhighlight threedlightshadow "
    "threedshadow visitedtext window windowframe windowtext ";

bool is_name(std::string_view text) {
  if (text.empty() ||
      text.find_first_not_of("abcdefghijklmnopqrstuvwxyz") != std::string_view::npos)
    return false;
  return colour_named(text) ||
         other_names.find(fmt::format(" {} ", text)) != std::string_view::npos;
}

/// "#rgb", "#rgba", "#rrggbb", "#rrggbbaa".
std::optional<SvgColour> hexadecimal(std::string_view digits) {
  const std::size_t size = digits.size(), each = size <= 4 ? 1 : 2;
  const bool is_known = size == 3 || size == 4 || size == 6 || size == 8;
  const bool is_hex = digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
  if (!is_known || !is_hex) return std::nullopt;
  SvgColour colour;
  if (size / each == 4) {
    const std::string_view alpha = digits.substr(3 * each);
    int value = 0;
    std::from_chars(alpha.data(), alpha.data() + alpha.size(), value, 16);
    colour.alpha = value / (each == 1 ? 15.0 : 255.0);
  }
  const std::string_view rgb = digits.substr(0, 3 * each);
  colour.is_white = colour.alpha >= 1 && rgb.find_first_not_of('f') == std::string_view::npos;
  return colour;
}

/// An argument of a function: a number, a percentage or an angle.
struct Argument {
  double value = 0;
  bool is_percent = false;
  /// At least the whole range, whose end is `whole` without a percent sign.
  bool is_full(double whole) const { return value >= (is_percent ? 100 : whole); }
};

std::optional<Argument> argument_of(std::string_view text) {
  if (text == "none") return Argument{};
  if (text.starts_with('+')) text.remove_prefix(1);
  Argument argument;
  const auto [end, failure] =
      std::from_chars(text.data(), text.data() + text.size(), argument.value);
  if (failure != std::errc{}) return std::nullopt;
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  argument.is_percent = unit == "%";
  constexpr std::array<std::string_view, 6> units{"", "%", "deg", "rad", "grad", "turn"};
  if (std::find(units.begin(), units.end(), unit) == units.end()) return std::nullopt;
  return argument;
}

std::optional<SvgColour> function(std::string_view name, std::string_view text) {
  constexpr std::array<std::string_view, 5> with_three{"rgb", "rgba", "hsl", "hsla", "hwb"};
  constexpr std::array<std::string_view, 4> with_lightness{"lab", "lch", "oklab", "oklch"};
  constexpr std::array<std::string_view, 5> others{"color", "color-mix", "light-dark",
                                                   "device-cmyk", "var"};
  const auto is_one_of = [&](const auto& list) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  if (is_one_of(others)) return SvgColour{};
  if (!is_one_of(with_three) && !is_one_of(with_lightness)) return std::nullopt;
  std::vector<Argument> arguments;
  constexpr std::string_view separators = " \t\r\n,/";
  for (std::size_t begin = text.find_first_not_of(separators); begin < text.size();
       begin = text.find_first_not_of(separators, begin)) {
    const std::string_view one = text.substr(begin, text.find_first_of(separators, begin) - begin);
    const auto argument = argument_of(one);
    if (!argument) return std::nullopt;
    arguments.push_back(*argument);
    begin += one.size();
  }
  if (arguments.size() != 3 && arguments.size() != 4) return std::nullopt;
  SvgColour colour;
  if (arguments.size() == 4)
    colour.alpha = arguments[3].value / (arguments[3].is_percent ? 100 : 1);
  bool is_light = false;
  if (name.starts_with("rgb"))
    is_light = std::all_of(arguments.begin(), arguments.begin() + 3,
                           [](const Argument& one) { return one.is_full(255); });
  else if (name.starts_with("hsl"))
    is_light = arguments[2].is_full(100);
  else if (name == "hwb")
    is_light = arguments[1].is_full(100) && arguments[2].value <= 0;
  else
    is_light = arguments[0].is_full(name.starts_with("ok") ? 1 : 100);
  colour.is_white = is_light && colour.alpha >= 1;
  return colour;
}

}  // namespace

std::optional<SvgColour> find_svg_colour(std::string_view text) {
  const std::string plain = in_lower_case(trimmed(text));
  if (plain.starts_with('#')) return hexadecimal(std::string_view(plain).substr(1));
  if (is_name(plain)) return SvgColour{plain == "white", plain == "transparent" ? 0.0 : 1.0};
  const std::size_t open = plain.find('(');
  if (open == std::string::npos || !plain.ends_with(')')) return std::nullopt;
  const std::string_view inner(plain);
  return function(inner.substr(0, open), inner.substr(open + 1, plain.size() - open - 2));
}

bool is_svg_paint(std::string_view text) {
  const std::string plain = in_lower_case(trimmed(text));
  std::string_view paint = plain;
  if (paint.find("var(") != std::string_view::npos) return true;  // its value is not known
  if (paint.starts_with("url(")) {
    const std::size_t end = paint.find(')');
    if (end == std::string_view::npos) return false;
    paint = trimmed(paint.substr(end + 1));
    if (paint.empty()) return true;
  }
  // SVG 1.1 has a colour of a profile after that of the screen.
  if (const std::size_t icc = paint.find("icc-color("); icc != std::string_view::npos && icc > 0)
    paint = trimmed(paint.substr(0, icc));
  return paint == "none" || paint == "context-fill" || paint == "context-stroke" ||
         find_svg_colour(paint);
}

}  // namespace lamplock::model
