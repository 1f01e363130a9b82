#include "host/serve/page_document.hpp"

#include <stdexcept>
#include <string_view>

#include "host/serve/hashes.hpp"
#include "host/serve/page_files.hpp"

namespace lamplock::serve {

const PageDocument& page_document() {
  static const PageDocument document = [] {
    constexpr std::string_view place = "<style></style>";
    constexpr std::size_t inside = std::string_view("<style>").size();
    PageDocument made{std::string(page_html()), policy_hash(page_css())};
    const std::size_t at = made.html.find(place);
    if (at == std::string::npos) throw std::logic_error("page.html has no place for its style");
    made.html.insert(at + inside, page_css());
    return made;
  }();
  return document;
}

}  // namespace lamplock::serve
