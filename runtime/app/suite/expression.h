// Arithmetic written as text, such as "sqrt(P.x^2 + P.y^2) < 1": what an analytic check states.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// Numbers, names (letters, digits, _ and .), pi, parentheses, the functions
//   abs sqrt exp log sin cos tan asin acos atan floor ceil, atan2 min max pow mod, if(condition, then, else)
// and, from loosest to tightest, || and &&, the comparisons < <= > >= == != (1 or 0), + -, * /, unary - and
// !, and ^ (from right to left). Any operand that is NaN gives NaN, in min, max and the comparisons too, so
// that NaN is never hidden.
class Expression {
 public:
  // Null where the text is no expression, and `problem` then says why and at which character.
  static std::optional<Expression> parse(std::string_view text, std::string& problem);

  // Its names, each once, in order of appearance; evaluate() takes their values in that order.
  const std::vector<std::string>& names() const { return names_; }
  double evaluate(std::span<const double> values) const;

 private:
  friend class ExpressionParser;
  struct Step {
    enum class Kind : std::uint8_t { number, name, unary, binary, choose };
    Kind kind;
    double number = 0;
    std::size_t index = 0;  // of the name, or of the operation
  };
  std::vector<Step> steps_;  // in postfix order
  std::vector<std::string> names_;
  mutable std::vector<double> stack_;  // of evaluate(): one thread at a time
};

}  // namespace frustum
