// What a browser may load and run in the documents of the server (Content-Security-Policy).
//
// In:  hashes of a style, or a report. Out: the value of the header. Who: the web server, the
//      document of the page, reports.
#pragma once

#include <string>
#include <string_view>

namespace lamplock::serve {

/// No script, style or picture but this server's own and, with its hash, the style in the
/// document; no page may frame this one.
std::string page_policy(const std::string& style_hash = "");

/// For a document of one style and one script, such as a report: these two alone. It has no
/// access to the page and its token (sandbox: a separate origin), nor to any server.
std::string alone_policy(std::string_view html);

}  // namespace lamplock::serve
