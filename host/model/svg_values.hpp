// Values of SVG attributes: numbers, lengths, lists, transforms (W3C, "Scalable Vector Graphics
// (SVG) 1.1", chapters 4 and 7; CSS units).
//
// In:  the text of an attribute. Out: numbers, px, maps.
// Who: read_svg() and its path data.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "host/geometry/affine.hpp"
#include "host/model/file_position.hpp"

namespace lamplock::model {

/// Reads numbers from the front of a text: separated by blanks, commas or only by their signs and
/// points ("1-2.5.5" is three).
class SvgScanner {
 public:
  SvgScanner(std::string_view text, const FilePosition& place) : rest_(text), place_(place) {}

  /// Skips blanks and one comma.
  void skip_separator();
  bool at_end();
  /// Throws Error (bad_input) if there is no finite number.
  double number();
  /// One digit, 0 or 1, which needs no separator after it.
  bool flag();
  bool begins_number();
  /// Reads the next character that is no blank; 0 at the end.
  char take();
  /// Reads letters; empty if there are none.
  std::string_view word();
  std::string_view rest() const { return rest_; }
  const FilePosition& place() const { return place_; }

 private:
  void skip_blanks();

  std::string_view rest_;
  FilePosition place_;
};

/// All numbers of a text. Throws Error (bad_input) if it contains other text.
std::vector<double> svg_numbers(std::string_view text, const FilePosition& place);

/// A rectangle of the page or the user's own units.
struct SvgBox {
  double x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const SvgBox&, const SvgBox&) = default;
};

/// What relative lengths of an element refer to, in px.
struct SvgUnits {
  SvgBox port{};                                 ///< of percentages, in the element's units
  double font_px = 16, root_font_px = 16;        ///< em, rem; the default of browsers
  double page_width_px = 0, page_height_px = 0;  ///< of vw and vh
  friend bool operator==(const SvgUnits&, const SvgUnits&) = default;
};

/// A length in px (96 an inch); a percentage refers to `whole_px`. Empty if it is not a length.
std::optional<double> find_svg_length(std::string_view text, double whole_px,
                                      const SvgUnits& units);
/// The same. Throws Error (bad_input) for other text.
double svg_length(std::string_view text, double whole_px, const SvgUnits& units,
                  const FilePosition& place);

/// The font size of an element by its attribute; that of the parent is in `units`.
double svg_font_size(std::string_view text, const SvgUnits& units);

/// The map of a transform attribute or of the property of CSS, whose numbers have units. Throws
/// Error (bad_input).
geometry::Affine svg_transform(std::string_view text, const SvgUnits& units,
                               const FilePosition& place);

/// Fits `view` into `port` by preserveAspectRatio; empty: centred and whole.
geometry::Affine svg_fit(const SvgBox& view, const SvgBox& port, std::string_view aspect);

}  // namespace lamplock::model
