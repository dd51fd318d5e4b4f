#include "runtime/buffers/value.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"
#include "runtime/core/param.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

// Reads a literal as a parameter of type T is read; null where that reported a problem.
template <class T>
bool read_literal(const Json& json, T& value, ParamReader& reader) {
  const std::size_t before = reader.problems();
  param_type<T>().read(json, &value, ParamOptions{}, reader);
  return reader.problems() == before;
}

struct NumberOps {
  static std::size_t bytes(const Number& n) { return sizeof n; }
  static void hash(const Number& n, Hasher& h) { h.value(n.value); }
  static Health health(const Number& n) {
    const std::pair<std::string_view, double> values[] = {{"value", n.value}};
    return health_of("number", values);
  }
  static void save(const Number& n, ArchiveWriter& w) { w.value(n.value); }
  static Number load(ArchiveReader& r) { return {r.value<double>()}; }
  static Json summary(const Number& n) { return {{"value", json_number(n.value)}}; }
  static Json table(const Number& n, std::size_t first, std::size_t count) {
    return json_table({"value"}, 1, first, count,
                      [&](std::size_t) { return Json::array({json_number(n.value)}); });
  }
  static Buffer from_json(const Json& json, ParamReader& reader) {
    auto n = std::make_shared<Number>();
    return read_literal(json, n->value, reader) ? Buffer(Ref<Number>(std::move(n))) : Buffer();
  }
};

struct MatrixOps {
  static std::size_t bytes(const Matrix& m) { return sizeof m; }
  static void hash(const Matrix& m, Hasher& h) { h.bytes(&m.value[0][0], 16 * sizeof(double)); }
  static Health health(const Matrix& m) {
    return to_health(scan(std::span<const double>(&m.value[0][0], 16)), 16,
                     [](std::size_t i) { return fmt::format("matrix, row {} column {}", i % 4, i / 4); });
  }
  static void save(const Matrix& m, ArchiveWriter& w) { w.raw(&m.value, sizeof m.value); }
  static Matrix load(ArchiveReader& r) {
    Matrix m;
    r.raw(&m.value, sizeof m.value);
    return m;
  }
  static Json rows(const Matrix& m) {
    Json out = Json::array();
    for (int r = 0; r < 4; ++r) {
      Json row = Json::array();
      for (int c = 0; c < 4; ++c) row.push_back(json_number(m.value[c][r]));
      out.push_back(std::move(row));
    }
    return out;
  }
  static Json summary(const Matrix& m) { return {{"rows", rows(m)}}; }
  static Json table(const Matrix& m, std::size_t first, std::size_t count) {
    const Json all = rows(m);
    return json_table({"x", "y", "z", "w"}, 4, first, count, [&](std::size_t i) { return all[i]; });
  }
  static Buffer from_json(const Json& json, ParamReader& reader) {
    auto m = std::make_shared<Matrix>();
    return read_literal(json, m->value, reader) ? Buffer(Ref<Matrix>(std::move(m))) : Buffer();
  }
};

struct TableOps {
  static std::size_t bytes(const Table& t) {
    std::size_t sum = sizeof t;
    for (const auto& c : t.columns) {
      sum += sizeof c + c.numbers.size() * sizeof(double);
      for (const std::string& text : c.texts) sum += sizeof text + text.size();
    }
    return sum;
  }
  static void hash(const Table& t, Hasher& h) {
    h.value(t.columns.size());
    for (const auto& c : t.columns) {
      h.text(c.name).text(c.unit).span<double>(c.numbers).value(c.texts.size());
      for (const std::string& text : c.texts) h.text(text);
    }
  }
  static void save(const Table& t, ArchiveWriter& w) {
    w.value(std::uint64_t{t.columns.size()});
    for (const auto& c : t.columns) {
      w.text(c.name).text(c.unit).span<double>(c.numbers).value(std::uint64_t{c.texts.size()});
      for (const std::string& text : c.texts) w.text(text);
    }
  }
  static Table load(ArchiveReader& r) {
    Table t;
    for (std::size_t n = r.count(1); n > 0; --n) {
      Table::Column& c = t.columns.emplace_back();
      c.name = r.text();
      c.unit = r.text();
      c.numbers = r.vector<double>();
      for (std::size_t texts = r.count(8); texts > 0; --texts) c.texts.push_back(r.text());
    }
    return t;
  }
  static Health health(const Table& t) {
    Health sum;
    for (const auto& c : t.columns)
      sum.add(to_health(scan(std::span<const double>(c.numbers)), c.numbers.size(),
                        [&](std::size_t i) { return fmt::format("column {}, row {}", c.name, i); }));
    return sum;
  }
  static Json summary(const Table& t) {
    Json columns = Json::array();
    for (const auto& c : t.columns) {
      Json column = {{"name", c.name}};
      if (!c.unit.empty()) column["unit"] = c.unit;
      if (c.texts.empty()) column.update(to_json(measure(c.numbers)));
      columns.push_back(std::move(column));
    }
    return {{"rows", t.rows()}, {"columns", std::move(columns)}};
  }
  static Json table(const Table& t, std::size_t first, std::size_t count) {
    Json names = Json::array();
    for (const auto& c : t.columns)
      names.push_back(c.unit.empty() ? c.name : fmt::format("{} [{}]", c.name, c.unit));
    return json_table(std::move(names), t.rows(), first, count, [&](std::size_t i) {
      Json row = Json::array();
      for (const auto& c : t.columns) {
        if (i < c.texts.size())
          row.push_back(c.texts[i]);
        else
          row.push_back(i < c.numbers.size() ? json_number(c.numbers[i]) : Json());
      }
      return row;
    });
  }
};

}  // namespace

std::size_t Table::rows() const {
  return columns.empty() ? 0 : std::max(columns[0].numbers.size(), columns[0].texts.size());
}

template <>
const BufferType& buffer_type<Number>() {
  static const BufferType type = make_buffer_type<Number, NumberOps>("number", "One real number.", "#9aa0a6");
  return type;
}
template <>
const BufferType& buffer_type<Matrix>() {
  static const BufferType type = make_buffer_type<Matrix, MatrixOps>(
      "matrix", "Four rows of four numbers, acting on column vectors.", "#a6806f");
  return type;
}
template <>
const BufferType& buffer_type<Table>() {
  static const BufferType type =
      make_buffer_type<Table, TableOps>("table", "Named columns of numbers or texts.", "#86a38f");
  return type;
}

}  // namespace frustum
