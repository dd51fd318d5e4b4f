#include "runtime/cli/inspect_text.h"

#include "runtime/core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum::cli {
namespace {

bool is_scalar_list(const Json& j) {
  return j.is_array() && std::none_of(j.begin(), j.end(), [](const Json& e) { return e.is_structured(); });
}

bool is_object_list(const Json& j) {
  return j.is_array() && !j.empty() &&
         std::all_of(j.begin(), j.end(), [](const Json& e) { return e.is_object(); });
}

// Objects have been told apart before; what is left of them is short.
std::string scalar(const Json& j) {
  if (j.is_string()) return j.get<std::string>();
  if (j.is_null()) return "none";
  if (j.is_number_float()) return fmt::format("{:.9g}", j.get<double>());
  if (!is_scalar_list(j)) return j.dump();
  std::vector<std::string> items;
  for (const Json& e : j) items.push_back(scalar(e));
  return fmt::format("{}", fmt::join(items, " "));
}

// Counts as bars, two buckets each; a bar that stands for anything shows.
std::string sparkline(const Json& counts) {
  std::vector<double> sums((counts.size() + 1) / 2);
  for (std::size_t i = 0; i < counts.size(); ++i) sums[i / 2] += counts[i].get<double>();
  const double most = sums.empty() ? 0 : *std::max_element(sums.begin(), sums.end());
  constexpr std::array<std::string_view, 8> bars{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  std::string out;
  for (const double n : sums) {
    const double share = most > 0 ? n / most : 0;
    out += share == 0 ? " " : bars[static_cast<std::size_t>(std::min(7.0, share * 8))];
  }
  return out;
}

using Cell = std::pair<std::string, std::string>;

constexpr std::array<std::pair<std::string_view, std::string_view>, 3> not_finite{
    {{"nan", "NaN"}, {"positive_infinity", "+inf"}, {"negative_infinity", "-inf"}}};

// "3 NaN, 1 +inf"; empty where all are finite.
std::string mark_of(const Json& item) {
  std::vector<std::string> found;
  for (const auto& [key, name] : not_finite)
    if (const auto n = item.find(key); n != item.end() && *n != 0)
      found.push_back(fmt::format("{} {}", scalar(*n), name));
  return fmt::format("{}", fmt::join(found, ", "));
}

// The cells of one object by column. Of the percentiles those that a line has room for; the rest are in the JSON.
void add_cells(const Json& item, std::vector<Cell>& out) {
  for (const auto& [key, value] : item.items()) {
    const bool counted = std::any_of(not_finite.begin(), not_finite.end(),
                                     [&, &key = key](const auto& n) { return n.first == key; });
    if (key == "percentiles") {
      for (const char* percent : {"5", "50", "95"})
        if (const auto at = value.find(percent); at != value.end())
          out.emplace_back(fmt::format("p{}", percent), scalar(*at));
    } else if (key == "histogram") {
      out.emplace_back(key, sparkline(value));
    } else if (!counted && !is_object_list(value)) {
      out.emplace_back(key, scalar(value));
    }
  }
  if (const std::string mark = mark_of(item); !mark.empty()) out.emplace_back("not finite", mark);
}

const Json* parts_of(const Json& item) {
  for (const auto& [key, value] : item.items())
    if (is_object_list(value)) return &value;
  return nullptr;
}

// One object is one row; one that has parts is a row a part: "position.x" says what the column position says of itself and
// then what is known of its x. Sizes and digests of columns are for programs.
std::vector<std::vector<Cell>> rows_of(const Json& item) {
  const Json* parts = parts_of(item);
  std::vector<std::vector<Cell>> rows;
  if (parts == nullptr) return add_cells(item, rows.emplace_back()), rows;
  Json own = item;
  for (const char* key : {"width", "bytes", "digest"}) own.erase(key);
  for (const Json& part : *parts) {
    std::vector<Cell>& row = rows.emplace_back();
    add_cells(own, row);
    std::vector<Cell> of_part;
    add_cells(part, of_part);
    for (Cell& cell : of_part) {
      if (cell.first != "name")
        row.push_back(std::move(cell));
      else if (parts->size() > 1 && !row.empty() && row.front().first == "name")
        row.front().second += "." + cell.second;
    }
  }
  return rows;
}

// Rows of cells under columns in order of first appearance, pictures last: they are the widest.
std::string cell_table(const std::vector<std::vector<Cell>>& rows, int indent) {
  std::vector<std::string> columns;
  for (const auto& row : rows)
    for (const Cell& cell : row)
      if (std::find(columns.begin(), columns.end(), cell.first) == columns.end())
        columns.push_back(cell.first);
  std::stable_partition(columns.begin(), columns.end(),
                        [](const std::string& c) { return c != "histogram"; });
  std::vector<std::vector<std::string>> out{columns};
  for (const auto& row : rows) {
    std::vector<std::string> line(columns.size());
    for (const Cell& cell : row)
      line[static_cast<std::size_t>(std::find(columns.begin(), columns.end(), cell.first) -
                                    columns.begin())] = cell.second;
    out.push_back(std::move(line));
  }
  return aligned(out, indent);
}

std::string object_table(const Json& list, int indent) {
  std::vector<std::vector<Cell>> rows;
  for (const Json& item : list)
    for (auto& row : rows_of(item)) rows.push_back(std::move(row));
  return cell_table(rows, indent);
}

// Rows of numbers, such as those of a matrix.
std::string number_rows(const Json& list, int indent) {
  std::vector<std::vector<std::string>> rows;
  for (const Json& row : list) {
    rows.emplace_back();
    for (const Json& value : row) rows.back().push_back(scalar(value));
  }
  return aligned(rows, indent);
}

bool is_statistics(const Json& j) { return j.is_object() && j.contains("count"); }

std::string lines(const Json& object, int indent) {
  std::string out;
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  Json measured = Json::array();
  for (const auto& [key, value] : object.items()) {
    if (is_statistics(value)) {
      measured.push_back({{"name", key}});
      measured.back().update(value);
    } else if (value.is_object()) {
      out += margin + key + "\n" + lines(value, indent + 2);
    } else if (is_object_list(value)) {
      out += margin + key + "\n" + object_table(value, indent + 2);
    } else if (value.is_array() && !value.empty() &&
               std::all_of(value.begin(), value.end(), is_scalar_list)) {
      out += margin + key + "\n" + number_rows(value, indent + 2);
    } else {
      const std::string text = scalar(value);
      out += fmt::format("{}{}: {}\n", margin, key, text.empty() ? "none" : text);
    }
  }
  return measured.empty() ? out : out + object_table(measured, indent);
}

// "64403, all finite", or what is not and where it begins.
std::string health_text(const Json& shown) {
  const std::string mark = mark_of(shown);
  if (mark.empty()) return scalar(shown["values"]) + ", all finite";
  const auto first = shown.find("first_not_finite");
  return fmt::format("{}, of which {}{}", scalar(shown["values"]), mark,
                     first == shown.end() ? "" : "; the first: " + scalar(*first));
}

}  // namespace

std::string buffer_text(const Json& shown) {
  std::string out;
  for (const char* key : {"port", "type", "bytes", "digest"})
    out += fmt::format("{}: {}\n", key, scalar(shown[key]));
  return out + fmt::format("values: {}\n", health_text(shown)) + lines(shown["summary"], 0);
}

std::string table_text(const Json& table, std::size_t first) {
  std::vector<std::vector<std::string>> rows{{"row"}};
  for (const Json& c : table["columns"]) rows.front().push_back(scalar(c));
  const auto is_marked = [](const Json& v) { return v == "nan" || v == "inf" || v == "-inf"; };
  bool any = false;
  for (const Json& r : table["rows"]) {
    const bool marked = std::any_of(r.begin(), r.end(), is_marked);
    any = any || marked;
    rows.push_back({fmt::format("{}{}", first + rows.size() - 1, marked ? " !" : "")});
    for (const Json& v : r) rows.back().push_back(scalar(v));
  }
  return aligned(rows) + fmt::format("{} rows in all{}\n", table["total"].get<std::size_t>(),
                                     any ? "; those with ! are not finite" : "");
}

std::string samples_text(const Json& samples) { return object_table(samples, 0); }

}  // namespace frustum::cli
