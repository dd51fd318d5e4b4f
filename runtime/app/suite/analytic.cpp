#include "runtime/app/suite/expression.h"
#include "runtime/app/suite/statements.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

// Where one name of an expression gets its value from, row by row.
class Source {
 public:
  Source(const std::string& name, const Values& v) : name_(name), v_(v) {
    static const std::vector<std::string> places{"x", "y", "u", "v", "width", "height"};
    const auto place = std::find(places.begin(), places.end(), name);
    if (const Series* whole = v.find(name); whole != nullptr && whole->width == 1)
      series_ = whole;
    else if (const auto dot = name.rfind('.'); dot != std::string::npos && dot + 2 == name.size())
      find_component(name.substr(0, dot), name[dot + 1]);
    else if (v.window && place != places.end())
      place_ = static_cast<int>(place - places.begin());
    else if (name == "row")
      place_ = row_number;
    if (series_ == nullptr && place_ < 0)
      throw NodeError("no_series",
                      fmt::format("'{}' is neither a plane nor a number of a column; there are {}", name,
                                  fmt::join(v.names(), ", ")));
  }

  std::size_t rows() const { return series_ != nullptr ? series_->rows() : 0; }
  double at(std::size_t row) const {
    if (series_ != nullptr)
      return series_->values[row * static_cast<std::size_t>(series_->width) + component_];
    if (place_ == row_number) return static_cast<double>(row);
    const auto width = static_cast<std::size_t>(v_.window->width()),
               height = static_cast<std::size_t>(v_.window->height());
    const double column = static_cast<double>(row % width) + 0.5,
                 line = static_cast<double>(row / width % height) + 0.5;
    switch (place_) {
      case 0: return v_.window->x0 + column;
      case 1: return v_.window->y0 + line;
      case 2: return column / static_cast<double>(width);
      case 3: return line / static_cast<double>(height);
      case 4: return static_cast<double>(width);
      default: return static_cast<double>(height);
    }
  }

 private:
  static constexpr int row_number = 100;

  void find_component(const std::string& column, char letter) {
    const auto k = std::string_view("xyzw").find(letter);
    const Series* s = v_.find(column);
    if (column.empty() || s == nullptr || k == std::string_view::npos ||
        k >= static_cast<std::size_t>(s->width))
      return;
    series_ = s, component_ = k;
  }

  std::string name_;
  const Values& v_;
  const Series* series_ = nullptr;
  std::size_t component_ = 0;
  int place_ = -1;
};

// An expression with the values of its names at hand.
class Formula {
 public:
  Formula(const std::string& text, const Values& v) {
    std::string problem;
    auto parsed = Expression::parse(text, problem);
    if (!parsed) throw NodeError("bad_expression", problem);
    expression_ = std::move(*parsed);
    for (const std::string& name : expression_.names()) sources_.emplace_back(name, v);
    values_.resize(sources_.size());
  }
  // Of its columns; every one has to have the same length.
  std::size_t rows(std::size_t known) const {
    for (const Source& s : sources_) {
      if (s.rows() == 0 || s.rows() == known) continue;
      if (known != 0)
        throw NodeError("wrong_length", "the columns of the expressions have different lengths");
      known = s.rows();
    }
    return known;
  }
  double at(std::size_t row) {
    for (std::size_t i = 0; i < sources_.size(); ++i) values_[i] = sources_[i].at(row);
    return expression_.evaluate(values_);
  }

 private:
  Expression expression_;
  std::vector<Source> sources_;
  std::vector<double> values_;
};

}  // namespace

std::vector<Judged> judge_analytic(const Analytic& a, const Buffer& buffer) {
  const Values v = values_of(buffer);
  Formula value(a.value, v), equals(a.equals, v), where(a.where.empty() ? "1" : a.where, v);
  std::size_t rows = where.rows(equals.rows(value.rows(0)));
  if (rows == 0 && !v.series.empty()) rows = v.series.front().rows();
  std::size_t seen = 0, wrong = 0;
  double worst = -1;
  std::string place;
  for (std::size_t row = 0; row < rows; ++row) {
    const double here = where.at(row);
    if (here == 0) continue;
    ++seen;
    const double x = value.at(row), expected = equals.at(row);
    const bool held = x == expected || close(x, expected, a.close, NumberKind::f64);
    if (held && !std::isnan(here)) continue;
    ++wrong;
    const double distance = std::isnan(x - expected) ? HUGE_VAL : std::abs(x - expected);
    if (distance <= worst) continue;
    worst = distance;
    const Series& first = v.series.front();
    place = fmt::format("{:.9g}, expected {:.9g}, in the row of {}", x, expected,
                        v.place(first, row * static_cast<std::size_t>(first.width)));
  }
  Judged j{{"", "analytic", fmt::format("{} of {} rows are off", wrong, seen), a.value + " = " + a.equals,
            wrong == 0 && seen > 0},
           ""};
  if (seen == 0)
    j.sentence =
        fmt::format("'{}' holds nowhere, so that nothing was checked", a.where.empty() ? "1" : a.where);
  else if (wrong != 0)
    j.sentence =
        fmt::format("{} is not {} in {} of {} rows; worst is {}", a.value, a.equals, wrong, seen, place);
  return {std::move(j)};
}

}  // namespace frustum
