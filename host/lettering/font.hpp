// Letters of a font as curves, with the kerning and the forms that the font has for its scripts.
//
// In:  a TrueType or OpenType font, lines of text. Out: outlines, in parts of the font size.
// Who: text_curves().
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/model/curves.hpp"

namespace lamplock::lettering {

/// A line of text that begins in the origin, x along the baseline, y upwards; the font size is 1.
struct LetteredLine {
  std::vector<model::Path> paths;  ///< closed
  double width = 0;                ///< to where the next letter would begin
  std::size_t missing = 0;         ///< letters that the font does not have
};

class Font {
 public:
  /// Throws Error(bad_input) if the file cannot be read or is not a font with outlines.
  explicit Font(const std::filesystem::path& file, unsigned index = 0);
  ~Font();
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  LetteredLine line(const std::string& text) const;
  const std::filesystem::path& file() const { return file_; }
  double capital() const { return capital_; }  ///< height of a capital letter
  double descent() const { return descent_; }  ///< from the baseline down, positive

 private:
  struct Shaper;
  std::filesystem::path file_;
  std::unique_ptr<Shaper> shaper_;
  double capital_ = 0, descent_ = 0;
};

/// The font of a file, or the one that the computer has for a name such as "sans" or "Arial:bold"
/// (fontconfig). Throws Error(bad_input) if there is none.
std::unique_ptr<Font> font_named(const std::string& name_or_file);

}  // namespace lamplock::lettering
