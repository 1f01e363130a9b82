// The parts that all pictures in SVG are made of.
//
// In:  pixels, plain text. Out: elements as text, well-formed whatever the text is.
// Who: the chart of `lamplock bench`, pictures of motion and of paths.
#pragma once

#include <string>

namespace lamplock::svg {

/// Plain text for use between tags. What is not UTF-8, in the name of a file perhaps, becomes a
/// question mark, a control character a space.
std::string escaped(const std::string& text);

/// Between the numbers of an axis: 1, 2 or 5 times a power of ten, so that no more than `most` fit
/// into the range.
double nice_step(double range, double most);

/// Text at a place; anchor: start, middle or end.
std::string text_at(double x, double y, const char* anchor, const std::string& text);
/// Text from below upwards, with its middle there.
std::string turned_text(double x, double y, const std::string& text);
/// A straight line; `dashes` as in stroke-dasharray, none if empty.
std::string line(double x1, double y1, double x2, double y2, const char* colour,
                 const char* dashes = "");

}  // namespace lamplock::svg
