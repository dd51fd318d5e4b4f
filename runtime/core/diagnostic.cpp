#include "runtime/core/diagnostic.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace frustum {
namespace {

constexpr std::string_view red = "\x1b[1;31m", yellow = "\x1b[1;33m", bold = "\x1b[1m", green = "\x1b[32m",
                           off = "\x1b[0m";

std::string_view name_of(Severity s) { return s == Severity::error ? "error" : "warning"; }

// Control characters of user text must neither end a line of ours nor drive the terminal.
std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out;
}

// "teapot.json:17:24 /nodes/cut/type", without the parts that are not known.
std::string place(std::string_view file, int line, int column, std::string_view pointer) {
  std::string out = printable(file);
  if (line > 0) out += fmt::format("{}{}:{}", out.empty() ? "" : ":", line, column);
  if (!pointer.empty()) out += fmt::format("{}{}", out.empty() ? "" : " ", printable(pointer));
  return out;
}

std::string quoted_list(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += fmt::format("{}'{}'", i == 0 ? "" : i + 1 == names.size() ? " or " : ", ", printable(names[i]));
  return out;
}

std::string_view paint(std::string_view code, bool color) { return color ? code : std::string_view{}; }

// "error[unknown_type]"
std::string heading(Severity severity, std::string_view code, bool color) {
  return fmt::format("{}{}[{}]{}", paint(severity == Severity::error ? red : yellow, color),
                     name_of(severity), code, paint(off, color));
}

void append_text(std::string& out, const Diagnostic& d, bool color) {
  const std::string where = place(d.file, d.line, d.column, d.pointer);
  out += fmt::format("{}{}{}{}{}\n", heading(d.severity, d.code, color), where.empty() ? "" : " ",
                     paint(bold, color), where, paint(off, color));
  out += fmt::format("  {}\n", printable(d.message));
  for (const Related& r : d.related)
    out += fmt::format("  {}: {}\n", place(r.file.empty() ? d.file : r.file, r.line, r.column, r.pointer),
                       printable(r.message));
  if (!d.suggestions.empty())
    out += fmt::format("  did you mean {}{}{}?\n", paint(green, color), quoted_list(d.suggestions),
                       paint(off, color));
}

Json to_json(const Related& r) {
  return {{"file", r.file},
          {"pointer", r.pointer},
          {"line", r.line},
          {"column", r.column},
          {"message", r.message}};
}

// Edits between two words, a swap of neighbours counting one (optimal string alignment), or limit + 1 where
// there are more than `limit`. Damerau 1964; restricted so that no substring is edited twice. Cells further
// than `limit` from the diagonal count more than that and are left out (Ukkonen 1985), so the cost is |a|
// (2 limit + 1).
class EditCounter {
 public:
  std::size_t operator()(std::string_view a, std::string_view b, std::size_t limit) {
    const std::size_t longer = std::max(a.size(), b.size()), shorter = std::min(a.size(), b.size());
    if (longer - shorter > limit) return limit + 1;
    const std::size_t far = limit + 1;
    before_.assign(b.size() + 1, far), row_ = above_ = before_;
    for (std::size_t j = 0; j <= std::min(b.size(), limit); ++j) above_[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
      const std::size_t first = i > limit ? i - limit : 1, last = std::min(b.size(), i + limit);
      row_[first - 1] = first == 1 ? i : far;
      std::size_t least = row_[first - 1];
      for (std::size_t j = first; j <= last; ++j) {
        const std::size_t replace = above_[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
        row_[j] = std::min({replace, above_[j] + 1, row_[j - 1] + 1, far});
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
          row_[j] = std::min(row_[j], before_[j - 2] + 1);
        least = std::min(least, row_[j]);
      }
      if (last < b.size()) row_[last + 1] = far;
      if (least > limit) return far;
      std::swap(before_, above_);
      std::swap(above_, row_);
    }
    return std::min(above_[b.size()], far);
  }

 private:
  std::vector<std::size_t> before_, above_, row_;
};

// Letters that say nothing about what was meant: the family, node or graph that two addresses both begin with.
std::size_t same_scope(std::string_view a, std::string_view b) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()) && a[i] == b[i]; ++i)
    if (a[i] == '.' || a[i] == ':' || a[i] == '/' || a[i] == '$') same = i + 1;
  return same;
}

// Whether so few edits make a name that was meant and not only another short one: fewer than half the letters
// of the longer, without the scope that both share; of one or two letters, one edit that changes a letter.
bool is_near(std::string_view name, std::string_view known, std::size_t count) {
  const std::size_t same = same_scope(name, known);
  if (name.size() - same < 3) return count == 1 && name.size() == known.size();
  return 2 * count < std::max(name.size(), known.size()) - same;
}

// What somebody meant who stopped writing early, proposed where no name is near: the shortest name, of those the first; null where there is none.
// One or two letters after the scope are too few to tell.
const std::string* shortest_beginning_with(std::string_view name, std::span<const std::string> known) {
  const std::string* found = nullptr;
  if (name.size() - same_scope(name, name) < 3) return found;
  for (const std::string& k : known)
    if (k.starts_with(name) && (found == nullptr || k.size() < found->size())) found = &k;
  return found;
}

}  // namespace

bool Diagnostics::has_errors() const {
  return std::any_of(list_.begin(), list_.end(),
                     [](const Diagnostic& d) { return d.severity == Severity::error; });
}

void Diagnostics::add(const Diagnostics& more) {
  list_.insert(list_.end(), more.list_.begin(), more.list_.end());
}

std::string to_text(const Diagnostics& diagnostics, bool color) {
  constexpr std::size_t most = 20;
  std::map<std::pair<Severity, std::string_view>, std::size_t> seen;
  std::string out;
  for (const Diagnostic& d : diagnostics.list())
    if (++seen[{d.severity, d.code}] <= most) append_text(out, d, color);
  for (const auto& [kind, times] : seen)
    if (times > most)
      out += fmt::format("{} and {} more; --json names them all\n", heading(kind.first, kind.second, color),
                         times - most);
  return out;
}

Json to_json(const Diagnostics& diagnostics) {
  Json list = Json::array();
  for (const Diagnostic& d : diagnostics.list()) {
    Json related = Json::array();
    for (const Related& r : d.related) related.push_back(to_json(r));
    list.push_back({{"code", d.code},
                    {"severity", name_of(d.severity)},
                    {"file", d.file},
                    {"pointer", d.pointer},
                    {"line", d.line},
                    {"column", d.column},
                    {"message", d.message},
                    {"expected", d.expected},
                    {"got", d.got},
                    {"suggestions", d.suggestions},
                    {"related", std::move(related)}});
  }
  return {{"diagnostics", std::move(list)}};
}

std::string child_pointer(std::string_view pointer, std::string_view key) {
  std::string out;
  out.reserve(pointer.size() + key.size() + 1);
  out.append(pointer).push_back('/');
  for (const char c : key) {
    if (c == '~')
      out += "~0";
    else if (c == '/')
      out += "~1";
    else
      out += c;
  }
  return out;
}

std::string child_pointer(std::string_view pointer, std::size_t index) {
  return child_pointer(pointer, std::to_string(index));
}

std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string> known) {
  // No name of ours is longer; the bound keeps a hostile key of a megabyte from costing more than a look.
  constexpr std::size_t longest = 200, most = 3;
  if (name.empty() || name.size() > longest) return {};
  const std::size_t limit = std::max<std::size_t>(1, name.size() / 3);
  std::vector<std::pair<std::size_t, const std::string*>> near;
  EditCounter edits;
  for (const std::string& k : known)
    if (const std::size_t n = edits(name, k, limit); n <= limit && is_near(name, k, n))
      near.emplace_back(n, &k);
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (near.size() > most) near.resize(most);
  std::vector<std::string> out;
  for (const auto& [n, k] : near)
    if (n <= near.front().first + 1) out.push_back(*k);  // beside a near name, far ones only distract
  if (const std::string* k = out.empty() ? shortest_beginning_with(name, known) : nullptr) out.push_back(*k);
  return out;
}

}  // namespace frustum
