// The text of an XML file in UTF-8 (W3C, "Extensible Markup Language (XML) 1.0", appendix F).
//
// In:  the bytes of a file. Out: the same text in UTF-8, with the same lines.
// Who: read_svg().
#pragma once

#include <string>

namespace lamplock::model {

/// Converts UTF-16 and UTF-32 of both byte orders, by their byte order mark or the zeros in their
/// first character, and ISO 8859-1 and Windows-1252 by the declaration; the mark of UTF-8 is
/// removed. Other bytes are returned as they are: the markup of the remaining encodings is ASCII.
/// A half character at the end of a damaged file becomes U+FFFD.
std::string xml_in_utf8(std::string bytes);

}  // namespace lamplock::model
