// The spaces a position passes through on its way to the screen.
//
// A column of positions carries the space it is in, and ports say which spaces they take and give, so that
// "clip after the divide" is an error of the graph and not a wrong picture.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <utility>

namespace frustum {

enum class Space : std::uint8_t { none, object, world, eye, clip, ndc, screen };

constexpr auto choices(Space) {
  return std::array{std::pair{Space::none, "none"},    std::pair{Space::object, "object"},
                    std::pair{Space::world, "world"},  std::pair{Space::eye, "eye"},
                    std::pair{Space::clip, "clip"},    std::pair{Space::ndc, "ndc"},
                    std::pair{Space::screen, "screen"}};
}

constexpr std::string_view name_of(Space space) {
  return choices(space)[static_cast<std::size_t>(space)].second;
}

// A set of spaces; empty means that space does not matter.
class Spaces {
 public:
  constexpr Spaces() = default;
  constexpr Spaces(Space s) : bits_(bit(s)) {}
  constexpr Spaces(std::initializer_list<Space> list) {
    for (const Space s : list) bits_ = static_cast<std::uint8_t>(bits_ | bit(s));
  }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr bool has(Space s) const { return (bits_ & bit(s)) != 0; }

 private:
  static constexpr std::uint8_t bit(Space s) {
    return static_cast<std::uint8_t>(1u << static_cast<unsigned>(s));
  }
  std::uint8_t bits_ = 0;
};

}  // namespace frustum
