// Writes DXF files for tests: text from groups separated by blanks, and the same in binary.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>

namespace lamplock::test {

/// Group codes and values separated by blanks, converted to one per line.
inline std::string dxf_lines(const std::string& groups) {
  std::istringstream words(groups);
  std::string text, code, value;
  while (words >> code >> value)
    text.append("  ").append(code).append("\n").append(value).append("\n");
  return text;
}

inline std::string dxf_section(const std::string& name, const std::string& groups) {
  return dxf_lines("0 SECTION 2 " + name + " " + groups + " 0 ENDSEC");
}

inline std::string dxf_drawing(const std::string& entities, const std::string& before = "") {
  return before + dxf_section("ENTITIES", entities) + dxf_lines("0 EOF");
}

/// The bytes of a number in little-endian order.
template <class Number>
std::string bytes_of(Number value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// The binary form of a text DXF; with codes of one byte as in release 12, or of two.
inline std::string binary_dxf(const std::string& text, bool short_codes) {
  std::string bytes("AutoCAD Binary DXF\r\n\x1a\0", 22);
  std::istringstream lines(text);
  std::string code_line, value;
  while (std::getline(lines, code_line) && std::getline(lines, value)) {
    const int code = std::atoi(code_line.c_str());
    if (!short_codes)
      bytes += bytes_of(static_cast<std::int16_t>(code));
    else if (code < 255)
      bytes += static_cast<char>(code);
    else
      bytes += '\xFF' + bytes_of(static_cast<std::int16_t>(code));
    const bool is_number = (code >= 10 && code < 60) || (code >= 110 && code < 150) ||
                           (code >= 210 && code < 240) || (code >= 1010 && code < 1060);
    if (is_number)
      bytes += bytes_of(std::atof(value.c_str()));
    else if ((code >= 60 && code < 80) || (code >= 270 && code < 290))
      bytes += bytes_of(static_cast<std::int16_t>(std::atoi(value.c_str())));
    else if (code >= 90 && code < 100)
      bytes += bytes_of(static_cast<std::int32_t>(std::atoi(value.c_str())));
    else if (code >= 290 && code < 300)
      bytes += static_cast<char>(std::atoi(value.c_str()));
    else if (code >= 310 && code < 320)
      bytes += static_cast<char>(value.size()) + value;
    else
      bytes += value + '\0';
  }
  return bytes;
}

}  // namespace lamplock::test
