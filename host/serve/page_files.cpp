#include "host/serve/page_files.hpp"

#include <algorithm>
#include <array>

namespace lamplock::serve {
namespace {

constexpr std::array page_table{
    PageFile{page_target, "text/html; charset=utf-8", page_html},
    PageFile{"/texts.js", "text/javascript; charset=utf-8", page_texts_js},
    PageFile{"/link.js", "text/javascript; charset=utf-8", page_link_js},
    PageFile{"/jog.js", "text/javascript; charset=utf-8", page_jog_js},
    PageFile{"/job.js", "text/javascript; charset=utf-8", page_job_js},
    PageFile{"/views.js", "text/javascript; charset=utf-8", page_views_js},
    PageFile{"/cloud_painter.js", "text/javascript; charset=utf-8", page_cloud_painter_js},
    PageFile{"/path_painter.js", "text/javascript; charset=utf-8", page_path_painter_js},
    PageFile{"/cloud.js", "text/javascript; charset=utf-8", page_cloud_js},
    PageFile{"/camera.js", "text/javascript; charset=utf-8", page_camera_js},
    PageFile{"/place.js", "text/javascript; charset=utf-8", page_place_js},
    PageFile{"/records.js", "text/javascript; charset=utf-8", page_records_js},
    PageFile{"/main.js", "text/javascript; charset=utf-8", page_main_js}};

}  // namespace

const PageFile* find_page_file(std::string_view target) {
  const auto* found =
      std::find_if(page_table.begin(), page_table.end(),
                   [target](const PageFile& page) { return page.target == target; });
  return found == page_table.end() ? nullptr : found;
}

}  // namespace lamplock::serve
