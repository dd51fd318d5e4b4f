#include "runtime/app/suite/select.h"

#include "runtime/core/digest.h"

#include <algorithm>

namespace frustum {
namespace {

bool matches(std::string_view glob, const SuiteCase& c) {
  if (glob_matches(glob, c.id)) return true;
  if (std::any_of(c.tags.begin(), c.tags.end(), [&](const auto& tag) { return glob_matches(glob, tag); }))
    return true;
  for (std::size_t end = c.id.find_first_of("/["); end != std::string::npos;
       end = c.id.find_first_of("/[", end + 1))
    if (glob_matches(glob, std::string_view(c.id).substr(0, end))) return true;
  return false;
}

}  // namespace

bool glob_matches(std::string_view pattern, std::string_view text) {
  // After the last star seen: where the pattern goes on, and how much of the text that star has eaten.
  std::size_t p = 0, t = 0, star = std::string_view::npos, eaten = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = ++p, eaten = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p, ++t;
    } else if (star != std::string_view::npos) {
      p = star, t = ++eaten;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

bool chosen(const SuiteCase& c, const std::vector<std::string>& filters) {
  bool wanted = false, any = false;
  for (const std::string& f : filters) {
    if (f.starts_with('!')) {
      if (matches(std::string_view(f).substr(1), c)) return false;
    } else {
      any = true, wanted = wanted || matches(f, c);
    }
  }
  return wanted || !any;
}

bool in_shard(const Shard& shard, std::string_view suite, std::string_view id) {
  const Digest d = Hasher().text(suite).text(id).done();
  return d.low % static_cast<std::uint64_t>(shard.count) == static_cast<std::uint64_t>(shard.index - 1);
}

}  // namespace frustum
