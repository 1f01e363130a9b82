#include "host/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace lamplock::svg {
namespace {

/// Bytes of the character that begins at `i`; 0 if it is not valid UTF-8 (RFC 3629).
std::size_t character_length(const std::string& text, std::size_t i) {
  const auto byte = [&text](std::size_t at) {
    return at < text.size() ? static_cast<unsigned char>(text[at]) : 0u;
  };
  const unsigned lead = byte(i);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xc2 && lead <= 0xdf   ? 2
                             : lead >= 0xe0 && lead <= 0xef ? 3
                             : lead >= 0xf0 && lead <= 0xf4 ? 4
                                                            : 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(i + k) & 0xc0) != 0x80) return 0;
  // Overlong sequences, surrogates, codes above the last character.
  const unsigned second = byte(i + 1);
  if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second > 0x9f) ||
      (lead == 0xf0 && second < 0x90) || (lead == 0xf4 && second > 0x8f))
    return 0;
  return length;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text, i);
    const char c = text[i];
    if (length == 0)
      out += '?';
    else if (length > 1)
      out += text.substr(i, length);
    else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    i += length == 0 ? 1 : length;
  }
  return out;
}

double nice_step(double range, double most) {
  const double least = range / most;
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

std::string opening(double width, double height, const char* background, int font_size) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"{3}\">\n"
      "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"{2}\"/>\n",
      width, height, background, font_size);
}

std::string heading(double x, double y, const std::string& text) {
  return "<g font-weight=\"bold\">" + text_at(x, y, "start", text) + "</g>\n";
}

std::string shade(double part) {
  struct Colour {
    double red, green, blue;
  };
  // Three stops, linear between them.
  constexpr std::array<Colour, 3> stops{{{245, 200, 90}, {216, 85, 40}, {75, 12, 90}}};
  const double at = 2 * std::clamp(part, 0.0, 1.0);
  const std::size_t i = at < 1 ? 0 : 1;
  const double t = at - static_cast<double>(i);
  const Colour &a = stops[i], &b = stops[i + 1];
  const auto mix = [t](double x, double y) {
    return static_cast<int>(std::lround(x + (y - x) * t));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(a.red, b.red), mix(a.green, b.green),
                     mix(a.blue, b.blue));
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     escaped(text));
}

std::string turned_text(double x, double y, const std::string& text) {
  return fmt::format(
      "<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      x, y, escaped(text));
}

std::string line(double x1, double y1, double x2, double y2, const char* colour,
                 const char* dashes) {
  const std::string dashed = *dashes == 0 ? "" : fmt::format(" stroke-dasharray=\"{}\"", dashes);
  return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\"{}/>\n", x1, y1, x2, y2,
                     colour, dashed);
}

}  // namespace lamplock::svg
