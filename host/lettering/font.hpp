// Letters of a font as curves, with the kerning and the forms that the font has for its scripts.
//
// In:  a TrueType or OpenType font, lines of text. Out: outlines, in parts of the font size.
// Who: text_curves().
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "host/lettering/letters.hpp"

namespace lamplock::lettering {

/// Outlines of letters: closed paths.
class Font final : public Letters {
 public:
  /// Throws Error(bad_input) if the file cannot be read or is not a font with outlines.
  explicit Font(const std::filesystem::path& file, unsigned index = 0);
  ~Font() override;
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  LetteredLine line(const std::string& text) const override;
  std::string name() const override { return file_.string(); }
  double capital() const override { return capital_; }
  double descent() const override { return descent_; }

 private:
  struct Shaper;
  std::filesystem::path file_;
  std::unique_ptr<Shaper> shaper_;
  double capital_ = 0, descent_ = 0;
};

/// The font of a file, or the one that the computer has for a name such as "sans" or "Arial:bold"
/// (fontconfig). Throws Error(bad_input) if there is none, or none of this name or an alias of it.
std::unique_ptr<Font> font_named(const std::string& name_or_file);

}  // namespace lamplock::lettering
