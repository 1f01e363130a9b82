// Common parts of all pictures in SVG.
//
// In:  pixels, plain text. Out: elements as text, well-formed for any text.
// Who: the chart of `lamplock bench`, pictures of motion and of paths.
#pragma once

#include <string>

namespace lamplock::svg {

/// Plain text for use between tags. Bytes that are not UTF-8, for example in a file name, become
/// question marks, control characters spaces.
std::string escaped(const std::string& text);

/// Step between the numbers of an axis: 1, 2 or 5 times a power of ten, with at most `most` steps
/// in the range.
double nice_step(double range, double most);

/// The beginning of a picture of this size in pixels, with its background: a colour as in fill.
/// "</svg>" ends it.
std::string opening(double width, double height, const char* background = "#fafafa",
                    int font_size = 12);
/// Bold text that begins at a position.
std::string heading(double x, double y, const std::string& text);

/// Colour of a part of the range, 0 to 1: light yellow over orange to dark purple.
std::string shade(double part);

/// Text at a position; anchor: start, middle or end.
std::string text_at(double x, double y, const char* anchor, const std::string& text);
/// Text from bottom to top, with its middle at the position.
std::string turned_text(double x, double y, const std::string& text);
/// A straight line; `dashes` as in stroke-dasharray, none if empty.
std::string line(double x1, double y1, double x2, double y2, const char* colour,
                 const char* dashes = "");

}  // namespace lamplock::svg
