#include "host/model/xml_text.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "host/letter_case.hpp"
#include "host/model/utf8.hpp"

namespace lamplock::model {
namespace {

/// Units of `width` bytes.
struct Units {
  std::string_view bytes;
  std::size_t width;
  bool big_endian;

  std::size_t count() const { return (bytes.size() + width - 1) / width; }
  std::uint32_t operator[](std::size_t i) const {
    const std::string_view unit = bytes.substr(i * width, width);
    if (unit.size() < width) return replacement_character;
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < width; ++k)
      value = value << 8U | static_cast<unsigned char>(unit[big_endian ? k : width - 1 - k]);
    return value;
  }
};

std::string from_units(const Units& units) {
  std::string text;
  for (std::size_t i = 0; i < units.count(); ++i) {
    std::uint32_t code = units[i];
    const bool is_pair = units.width == 2 && code >= 0xD800 && code < 0xDC00 &&
                         i + 1 < units.count() && units[i + 1] >= 0xDC00 && units[i + 1] < 0xE000;
    if (is_pair) code = 0x10000 + ((code - 0xD800) << 10U) + (units[++i] - 0xDC00);
    append_utf8(text, code);
  }
  return text;
}

/// The characters of both sets above 127 are in no markup: those of Windows-1252 that differ from
/// ISO 8859-1 may become control characters of names.
std::string from_latin1(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) append_utf8(text, static_cast<unsigned char>(c));
  return text;
}

/// True for a declaration of ISO 8859-1 or Windows-1252.
bool declares_latin1(std::string_view bytes) {
  if (!bytes.starts_with("<?xml")) return false;
  const std::string declaration =
      in_lower_case(bytes.substr(0, std::min(bytes.find("?>"), std::size_t{200})));
  const auto has = [&](std::string_view name) {
    return declaration.find(name) != std::string::npos;
  };
  return has("iso-8859-1") || has("latin1") || has("latin-1") || has("windows-1252");
}

}  // namespace

std::string xml_in_utf8(std::string bytes) {
  struct Mark {
    std::string_view bytes;
    std::size_t width;
    bool big_endian;
    std::size_t skipped;
  };
  using namespace std::string_view_literals;
  // Those of UTF-32 first: that of little-endian UTF-16 begins the other.
  constexpr Mark marks[] = {{"\xFF\xFE\0\0"sv, 4, false, 4}, {"\0\0\xFE\xFF"sv, 4, true, 4},
                            {"<\0\0\0"sv, 4, false, 0},      {"\0\0\0<"sv, 4, true, 0},
                            {"\xFF\xFE"sv, 2, false, 2},     {"\xFE\xFF"sv, 2, true, 2},
                            {"<\0"sv, 2, false, 0},          {"\0<"sv, 2, true, 0}};
  for (const Mark& mark : marks) {
    if (!bytes.starts_with(mark.bytes)) continue;
    return from_units({std::string_view(bytes).substr(mark.skipped), mark.width, mark.big_endian});
  }
  if (bytes.starts_with("\xEF\xBB\xBF")) return bytes.substr(3);
  return declares_latin1(bytes) ? from_latin1(bytes) : std::move(bytes);
}

}  // namespace lamplock::model
