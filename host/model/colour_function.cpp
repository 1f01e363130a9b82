#include "host/model/colour_function.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "host/text.hpp"

namespace lamplock::model {
namespace {

using Rgb = std::array<double, 3>;  ///< 0..1

/// An argument of a function, without its unit.
struct ColourArgument {
  double value = 0;
  std::string_view unit{};
};

std::optional<ColourArgument> colour_argument(std::string_view text) {
  if (text == "none") return ColourArgument{};
  if (text.starts_with('+')) text.remove_prefix(1);
  const std::size_t digit = text.find_last_of("0123456789.");
  if (digit == std::string_view::npos) return std::nullopt;
  const auto value = number_of<double>(text.substr(0, digit + 1));
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return ColourArgument{*value, text.substr(digit + 1)};
}

/// Three arguments, and a fourth one that is the alpha.
std::optional<std::array<ColourArgument, 3>> colour_arguments(std::string_view text) {
  constexpr std::string_view separators = " \t\r\n,/";
  std::array<ColourArgument, 3> arguments;
  std::size_t count = 0;
  for (std::size_t begin = text.find_first_not_of(separators); begin < text.size();
       begin = text.find_first_not_of(separators, begin)) {
    const std::string_view one = text.substr(begin, text.find_first_of(separators, begin) - begin);
    begin += one.size();
    const auto argument = colour_argument(one);
    if (!argument || count > arguments.size()) return std::nullopt;
    if (count < arguments.size()) arguments[count] = *argument;
    ++count;
  }
  if (count < arguments.size()) return std::nullopt;
  return arguments;
}

/// A part of one, of a number or of percent.
std::optional<double> share_of(const ColourArgument& argument, double whole) {
  if (argument.unit == "%") return std::clamp(argument.value / 100, 0.0, 1.0);
  if (!argument.unit.empty()) return std::nullopt;
  return std::clamp(argument.value / whole, 0.0, 1.0);
}

/// Degrees, 0 to 360.
std::optional<double> hue_of(const ColourArgument& argument) {
  constexpr double degrees_per_radian = 57.295779513082321;
  constexpr std::array<std::pair<std::string_view, double>, 5> units{
      {{"", 1}, {"deg", 1}, {"grad", 0.9}, {"rad", degrees_per_radian}, {"turn", 360}}};
  for (const auto& [name, degrees] : units) {
    if (argument.unit != name) continue;
    const double hue = std::fmod(argument.value * degrees, 360);
    return hue < 0 ? hue + 360 : hue;
  }
  return std::nullopt;
}

/// CSS Color Module Level 4, section 7.1, "Converting HSL Colors to sRGB".
Rgb rgb_of_hsl(double hue, double saturation, double lightness) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue / 30, 12);
    const double a = saturation * std::min(lightness, 1 - lightness);
    return lightness - a * std::max(-1.0, std::min({k - 3, 9 - k, 1.0}));
  };
  return {channel(0), channel(8), channel(4)};
}

/// Section 8.1, "Converting HWB Colors to sRGB".
Rgb rgb_of_hwb(double hue, double white, double black) {
  if (white + black >= 1) {
    const double grey = white / (white + black);
    return {grey, grey, grey};
  }
  Rgb rgb = rgb_of_hsl(hue, 1, 0.5);
  for (double& channel : rgb) channel = channel * (1 - white - black) + white;
  return rgb;
}

Colour colour_of_rgb(const Rgb& rgb) {
  Colour colour = 0;
  for (const double channel : rgb)
    colour = colour << 8 | static_cast<Colour>(std::lround(std::clamp(channel, 0.0, 1.0) * 255));
  return colour;
}

}  // namespace

std::optional<Colour> colour_of_function(std::string_view text) {
  const std::size_t open = text.find('(');
  if (open == std::string_view::npos || !text.ends_with(')')) return std::nullopt;
  const std::string_view name = text.substr(0, open);
  const bool is_rgb = name == "rgb" || name == "rgba", is_hwb = name == "hwb";
  if (!is_rgb && !is_hwb && name != "hsl" && name != "hsla") return std::nullopt;
  const auto arguments = colour_arguments(text.substr(open + 1, text.size() - open - 2));
  if (!arguments) return std::nullopt;
  const auto& [first, second, third] = *arguments;
  const double whole = is_rgb ? 255 : 100;
  const auto begin = is_rgb ? share_of(first, whole) : hue_of(first);
  const auto middle = share_of(second, whole), end = share_of(third, whole);
  if (!begin || !middle || !end) return std::nullopt;
  if (is_rgb) return colour_of_rgb({*begin, *middle, *end});
  return colour_of_rgb(is_hwb ? rgb_of_hwb(*begin, *middle, *end)
                              : rgb_of_hsl(*begin, *middle, *end));
}

}  // namespace lamplock::model
