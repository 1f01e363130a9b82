#include "host/serve/content_policy.hpp"

#include <fmt/format.h>

#include "host/serve/hashes.hpp"

namespace lamplock::serve {
namespace {

/// Empty if there is no such element.
std::string_view content_of(std::string_view html, std::string_view open, std::string_view close) {
  const std::size_t begin = html.find(open);
  if (begin == std::string_view::npos) return {};
  html.remove_prefix(begin + open.size());
  return html.substr(0, html.find(close));
}

}  // namespace

std::string page_policy(const std::string& style_hash) {
  return fmt::format(
      "default-src 'none'; script-src 'self'; style-src '{}'; img-src 'self' data: blob:; "
      "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
      style_hash.empty() ? "self" : style_hash);
}

std::string alone_policy(std::string_view html) {
  return fmt::format(
      "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; "
      "form-action 'none'; frame-ancestors 'none'; sandbox allow-scripts",
      policy_hash(content_of(html, "<script>", "</script>")),
      policy_hash(content_of(html, "<style>", "</style>")));
}

}  // namespace lamplock::serve
