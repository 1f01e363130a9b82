// The page as one document: its style is in it, so that the first picture needs one request.
#pragma once

#include <string>

namespace lamplock::serve {

struct PageDocument {
  std::string html;
  std::string style_hash;  ///< for the policy, which permits no other style
};

/// Made once from the embedded files.
const PageDocument& page_document();

}  // namespace lamplock::serve
