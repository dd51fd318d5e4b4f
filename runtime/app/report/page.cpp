#include "runtime/app/report/page.h"

#include "runtime/app/report_assets.h"

#include <nlohmann/json.hpp>

#include <map>

namespace frustum::report {
namespace {

// JSON inside a <script> element: no '<' at all, so that no text of a graph can end the element.
std::string script_safe(const Json& data) {
  std::string out;
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

// As text of a page: bytes that are no UTF-8 become replacement characters.
std::string escaped(std::string_view raw) {
  const std::string text = Json::parse(Json(raw).dump(-1, ' ', false, Json::error_handler_t::replace));
  std::string out;
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

// The modules as one script: in one page they share their scope, so what they import and export is there.
std::string as_one_script(std::string_view modules) {
  std::string out;
  for (std::size_t at = 0; at < modules.size();) {
    const std::size_t end = std::min(modules.find('\n', at), modules.size());
    std::string_view line = modules.substr(at, end - at);
    if (line.starts_with("export ")) line.remove_prefix(7);
    if (!line.starts_with("import ")) out.append(line).push_back('\n');
    at = end + 1;
  }
  return out;
}

// The template with every {{name}} replaced; what is put in is not looked at again.
std::string filled(std::string_view page, const std::map<std::string_view, std::string>& parts) {
  std::string out;
  for (;;) {
    const auto open = page.find("{{"), close = page.find("}}", open);
    out += page.substr(0, open);
    if (close == std::string_view::npos) return out;
    out += parts.at(page.substr(open + 2, close - open - 2));
    page.remove_prefix(close + 2);
  }
}

struct Parts {
  std::string_view style, script, entry;
};
Parts parts_of(Page page) {
  if (page == Page::suite) return {assets::suite_css, assets::suite_js, "showSuite"};
  return {{}, assets::report_js, "showReport"};
}

}  // namespace

std::string page_text(Page page, const Json& data, const Blobs& blobs) {
  const Parts parts = parts_of(page);
  return filled(assets::page_html, {{"title", escaped(data["title"].get<std::string>())},
                                    {"style", std::string(assets::style_css).append(parts.style)},
                                    {"script", as_one_script(parts.script)},
                                    {"entry", std::string(parts.entry)},
                                    {"data", script_safe(data)},
                                    {"blobs", blobs.html()}});
}

}  // namespace frustum::report
