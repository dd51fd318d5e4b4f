// A page that needs nothing else: template, style and modules of one kind of page, and its data.
#pragma once

#include "runtime/app/report/blobs.h"

#include <cstdint>
#include <string>

namespace frustum::report {

enum class Page : std::uint8_t {
  run,    // of `frustum report`: page.js
  suite,  // of `frustum test --html`: suite_page.js
};

// `data` has a "title"; every text in it is data and none is markup. The page loads nothing from anywhere.
std::string page_text(Page page, const Json& data, const Blobs& blobs);

}  // namespace frustum::report
