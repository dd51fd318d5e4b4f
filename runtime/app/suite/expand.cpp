#include "runtime/app/files.h"
#include "runtime/app/suite/read.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace frustum {
namespace fs = std::filesystem;
namespace {

using Matrix = std::map<std::string, std::vector<std::string>>;

void combine(Matrix::const_iterator axis, Matrix::const_iterator end, const SuiteCase& c,
             const std::string& chosen, std::vector<SuiteCase>& out) {
  if (axis == end) {
    out.push_back(c);
    if (!chosen.empty()) out.back().id += "[" + chosen + "]";
    return;
  }
  for (const std::string& value : axis->second) {
    SuiteCase next = c;
    next.settings.push_back({axis->first, value});
    const Json json = Json::parse(value);
    const std::string shown = json.is_string() ? json.get<std::string>() : value;
    combine(std::next(axis), end, next,
            fmt::format("{}{}{}={}", chosen, chosen.empty() ? "" : ",", axis->first, shown), out);
  }
}

}  // namespace

void Variation::override_with(const Variation& above) {
  for (const auto& [address, value] : above.set) matrix.erase(address), set[address] = value;
  for (const auto& [address, values] : above.matrix) set.erase(address), matrix[address] = values;
}

Expanded expand(const std::string& pattern, const SuiteCase& base, const Variation& v, std::size_t most,
                std::vector<SuiteCase>& out) {
  const auto files = matching_files(pattern);
  if (files.empty()) return Expanded::no_file;
  std::size_t combinations = files.size();
  for (const auto& [address, values] : v.matrix) {
    combinations *= values.size();  // both at most `most` here, so that the product is far from overflow
    if (combinations > most || values.size() > most) return Expanded::too_many;
  }
  if (combinations > most) return Expanded::too_many;
  const auto star = pattern.find('*');
  const fs::path fixed =
      star == std::string::npos ? fs::path() : fs::path(pattern.substr(0, star)).parent_path();
  for (const fs::path& file : files) {
    SuiteCase c = base;
    c.graph = file.generic_string();
    if (star != std::string::npos)
      c.id += "/" + fs::path(file).replace_extension().lexically_relative(fixed).generic_string();
    for (const auto& [address, value] : v.set) c.settings.push_back({address, value});
    combine(v.matrix.begin(), v.matrix.end(), c, "", out);
  }
  return Expanded::done;
}

}  // namespace frustum
