// JSON texts, as graphs and suites are read: held against the library's parser, which is another program.
#include "runtime/graph/source_text.h"
#include "tests/fuzz/support/check.h"
#include "tests/fuzz/support/target.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum::fuzz {
namespace {

// Every pointer into a value, by way of its members.
void check_places(const SourceText& text, const Json& value, const std::string& pointer, int lines) {
  for (const TextPlace p : {text.key_place(pointer), text.value_place(pointer)})
    require(p.line >= 1 && p.line <= lines && p.column >= 1, pointer + " stands outside the text");
  if (value.is_object())
    for (const auto& [key, member] : value.items())
      check_places(text, member, child_pointer(pointer, key), lines);
  if (value.is_array())
    for (std::size_t i = 0; i < value.size(); ++i)
      check_places(text, value[i], child_pointer(pointer, i), lines);
}

void read(std::string_view input) {
  Diagnostics problems;
  const auto text = SourceText::read(std::string(input), "input.json", problems);
  check_problems(problems, "input.json", input);
  require(text->complete() || problems.has_errors(), "a text was not understood and nobody says why");
  if (!text->complete()) require(text->json().is_null(), "half a text has a value");

  // Ours reads on after faults and refuses what is too deep or too large; without either, both agree.
  const Json theirs = Json::parse(input, nullptr, false);
  if (problems.empty()) require(theirs == text->json(), "the two parsers read different values");
  require(!theirs.is_discarded() || !problems.empty(), "what is no JSON was taken");
  check_places(*text, text->json(), "", 1 + static_cast<int>(std::count(input.begin(), input.end(), '\n')));
}
const Registered json({"json", read, {1 << 20, 2048}});

}  // namespace
}  // namespace frustum::fuzz
