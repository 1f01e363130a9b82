#include "host/serve/page_document.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "host/json_in_script.hpp"
#include "host/serve/content_policy.hpp"
#include "host/serve/hashes.hpp"
#include "host/serve/page_files.hpp"

namespace lamplock::serve {
namespace {

/// Inserts a text after the begin tag of an element that is empty in page.html.
void fill(std::string& html, std::string_view tag, std::string_view text) {
  const std::size_t at = html.find(tag);
  if (at == std::string::npos) throw std::logic_error("page.html has no " + std::string(tag));
  html.insert(at + tag.size(), text);
}

/// For the content of an element and of an attribute in quotation marks.
std::string html_text(std::string_view text) {
  std::string html;
  for (const char c : text) {
    if (c == '&')
      html += "&amp;";
    else if (c == '<')
      html += "&lt;";
    else if (c == '>')
      html += "&gt;";
    else if (c == '"')
      html += "&quot;";
    else
      html += c;
  }
  return html;
}

std::string with_texts(std::string_view page, const PageTexts& texts) {
  constexpr std::string_view open = "{{", close = "}}";
  std::string html;
  while (true) {
    const std::size_t begin = page.find(open);
    html += page.substr(0, begin);
    if (begin == std::string_view::npos) return html;
    page.remove_prefix(begin + open.size());
    const std::size_t end = page.find(close);
    html += html_text(texts.at(std::string(page.substr(0, end))));
    page.remove_prefix(end + close.size());
  }
}

}  // namespace

PageDocument page_document(const PageTexts& texts) {
  PageDocument made{with_texts(page_html(), texts), page_policy(policy_hash(page_css()))};
  fill(made.html, "<style>", page_css());
  fill(made.html, R"(<script type="application/json" id="texts">)",
       json_in_script(texts_of_document(texts)));
  return made;
}

}  // namespace lamplock::serve
