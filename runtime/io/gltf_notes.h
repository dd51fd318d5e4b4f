// What a file says that has no counterpart here: collected, and reported once a kind.
#pragma once

#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <fmt/format.h>

#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace frustum::gltf {

class Notes {
 public:
  // `what` finishes the sentence "ELEMENT ...": "has a normal texture, which is left out".
  void add(std::string_view element, std::string_view what) {
    const auto [it, fresh] = found_.try_emplace(std::string(what), std::string(element), 0);
    if (!fresh) ++it->second.second;
  }
  void report(const FilePath& file, Context& ctx) const {
    for (const auto& [what, where] : found_) {
      const auto& [first, more] = where;
      ctx.warn("not_mapped",
               more == 0 ? fmt::format("{}: {} {}", file.written, first, what)
                         : fmt::format("{}: {} {} (and {} more such)", file.written, first, what, more));
    }
  }

 private:
  std::map<std::string, std::pair<std::string, std::size_t>> found_;
};

}  // namespace frustum::gltf
