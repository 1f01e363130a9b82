// The page as one document: its style and texts are in it, so that the first picture needs one
// request.
#pragma once

#include <string>

#include "host/serve/page_texts.hpp"

namespace lamplock::serve {

struct PageDocument {
  std::string html;
  std::string policy;  ///< permits its style and no other one
};

/// The embedded page with these texts: {{name}} in page.html becomes a text; the scripts find the
/// table in the element `texts`. The texts need all names of english_texts().
PageDocument page_document(const PageTexts& texts);

}  // namespace lamplock::serve
