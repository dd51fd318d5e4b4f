#include "runtime/app/suite/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

namespace frustum {
namespace {

struct Unary {
  std::string_view name;
  double (*f)(double);
};
constexpr std::array<Unary, 14> unaries{{
    {"-", [](double a) { return -a; }},
    {"!", [](double a) { return std::isnan(a) ? a : static_cast<double>(a == 0); }},
    {"abs", [](double a) { return std::abs(a); }},
    {"sqrt", [](double a) { return std::sqrt(a); }},
    {"exp", [](double a) { return std::exp(a); }},
    {"log", [](double a) { return std::log(a); }},
    {"sin", [](double a) { return std::sin(a); }},
    {"cos", [](double a) { return std::cos(a); }},
    {"tan", [](double a) { return std::tan(a); }},
    {"asin", [](double a) { return std::asin(a); }},
    {"acos", [](double a) { return std::acos(a); }},
    {"atan", [](double a) { return std::atan(a); }},
    {"floor", [](double a) { return std::floor(a); }},
    {"ceil", [](double a) { return std::ceil(a); }},
}};

struct Binary {
  std::string_view name;
  int level;  // of precedence; 0: a function
  double (*f)(double, double);
};
// Longer operators stand before those that they begin with.
constexpr std::array<Binary, 18> binaries{{
    {"||", 1, [](double a, double b) { return static_cast<double>(a != 0 || b != 0); }},
    {"&&", 2, [](double a, double b) { return static_cast<double>(a != 0 && b != 0); }},
    {"<=", 3, [](double a, double b) { return static_cast<double>(a <= b); }},
    {">=", 3, [](double a, double b) { return static_cast<double>(a >= b); }},
    {"==", 3, [](double a, double b) { return static_cast<double>(a == b); }},
    {"!=", 3, [](double a, double b) { return static_cast<double>(a != b); }},
    {"<", 3, [](double a, double b) { return static_cast<double>(a < b); }},
    {">", 3, [](double a, double b) { return static_cast<double>(a > b); }},
    {"+", 4, [](double a, double b) { return a + b; }},
    {"-", 4, [](double a, double b) { return a - b; }},
    {"*", 5, [](double a, double b) { return a * b; }},
    {"/", 5, [](double a, double b) { return a / b; }},
    {"^", 7, [](double a, double b) { return std::pow(a, b); }},
    {"atan2", 0, [](double a, double b) { return std::atan2(a, b); }},
    {"min", 0, [](double a, double b) { return std::min(a, b); }},
    {"max", 0, [](double a, double b) { return std::max(a, b); }},
    {"pow", 0, [](double a, double b) { return std::pow(a, b); }},
    {"mod", 0, [](double a, double b) { return a - b * std::floor(a / b); }},
}};
constexpr int unary_level = 6, power_level = 7;
constexpr int max_depth = 100;

template <class Table>
std::size_t find(const Table& table, std::string_view name) {
  return static_cast<std::size_t>(
      std::find_if(table.begin(), table.end(), [&](const auto& e) { return e.name == name; }) -
      table.begin());
}

bool starts_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool in_name(char c) { return starts_name(c) || (c >= '0' && c <= '9') || c == '.'; }

}  // namespace

// Precedence climbing; a problem ends it by way of `stop`.
class ExpressionParser {
 public:
  explicit ExpressionParser(std::string_view text) : text_(text) {}

  std::optional<Expression> parse(std::string& problem) {
    try {
      binary(1, 0);
      skip();
      if (at_ < text_.size()) stop(fmt::format("'{}' is not expected", text_[at_]));
      return std::move(out_);
    } catch (const Stop& s) {
      problem = fmt::format("{} at character {} of '{}'", s.message, at_ + 1, text_);
      return std::nullopt;
    }
  }

 private:
  using Kind = Expression::Step::Kind;
  struct Stop {
    std::string message;
  };
  [[noreturn]] void stop(std::string message) const { throw Stop{std::move(message)}; }

  void skip() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool take(std::string_view token) {
    skip();
    if (!text_.substr(at_).starts_with(token)) return false;
    at_ += token.size();
    return true;
  }
  void expect(std::string_view token) {
    if (!take(token)) stop(fmt::format("expected '{}'", token));
  }

  void binary(int least, int depth) {
    if (depth > max_depth) stop("more than 100 parentheses inside each other");
    operand(depth);
    for (;;) {
      skip();
      const auto op = std::find_if(binaries.begin(), binaries.end(), [&](const Binary& b) {
        return b.level >= least && text_.substr(at_).starts_with(b.name);
      });
      if (op == binaries.end()) return;
      at_ += op->name.size();
      binary(op->level == power_level ? power_level : op->level + 1, depth + 1);
      push(Kind::binary, static_cast<std::size_t>(op - binaries.begin()));
    }
  }

  void operand(int depth) {
    skip();
    if (at_ >= text_.size()) stop("it ends where a number or a name is expected");
    for (const std::string_view sign : {"-", "!"})
      if (take(sign)) {
        binary(unary_level, depth + 1);
        return push(Kind::unary, find(unaries, sign));
      }
    if (take("(")) {
      binary(1, depth + 1);
      return expect(")");
    }
    if (starts_name(text_[at_])) return name(depth);
    number();
  }

  void number() {
    double value = 0;
    const char* const first = text_.data() + at_;
    const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) stop("expected a number or a name");
    at_ += static_cast<std::size_t>(end - first);
    out_.steps_.push_back({Kind::number, value, 0});
  }

  void name(int depth) {
    const std::size_t begin = at_;
    while (at_ < text_.size() && in_name(text_[at_])) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    if (take("(")) return call(word, begin, depth);
    if (word == "pi") {
      out_.steps_.push_back({Kind::number, std::numbers::pi, 0});
      return;
    }
    auto& names = out_.names_;
    const auto known = std::find(names.begin(), names.end(), word);
    push(Kind::name, static_cast<std::size_t>(known - names.begin()));
    if (known == names.end()) names.emplace_back(word);
  }

  void call(std::string_view word, std::size_t begin, int depth) {
    const std::size_t one = find(unaries, word), two = find(binaries, word);
    const int arguments = word == "if" ? 3 : one < unaries.size() ? 1 : two < binaries.size() ? 2 : 0;
    if (arguments == 0) {
      at_ = begin;
      stop(fmt::format("there is no function '{}'", word));
    }
    for (int i = 0; i < arguments; ++i) {
      if (i > 0) expect(",");
      binary(1, depth + 1);
    }
    expect(")");
    push(arguments == 3   ? Kind::choose
         : arguments == 1 ? Kind::unary
                          : Kind::binary,
         arguments == 1 ? one : two);
  }

  void push(Kind kind, std::size_t index) { out_.steps_.push_back({kind, 0, index}); }

  std::string_view text_;
  std::size_t at_ = 0;
  Expression out_;
};

std::optional<Expression> Expression::parse(std::string_view text, std::string& problem) {
  return ExpressionParser(text).parse(problem);
}

double Expression::evaluate(std::span<const double> values) const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  stack_.clear();
  const auto pop = [&] {
    const double v = stack_.back();
    stack_.pop_back();
    return v;
  };
  for (const Step& s : steps_) switch (s.kind) {
      case Step::Kind::number: stack_.push_back(s.number); break;
      case Step::Kind::name: stack_.push_back(values[s.index]); break;
      case Step::Kind::unary: stack_.back() = unaries[s.index].f(stack_.back()); break;
      case Step::Kind::binary: {
        const double b = pop(), a = pop();
        stack_.push_back(std::isnan(a) || std::isnan(b) ? nan : binaries[s.index].f(a, b));
        break;
      }
      case Step::Kind::choose: {
        const double otherwise = pop(), then = pop(), condition = pop();
        stack_.push_back(std::isnan(condition) ? nan : condition != 0 ? then : otherwise);
        break;
      }
    }
  return stack_.back();
}

}  // namespace frustum
