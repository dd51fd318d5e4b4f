// Parameters: from a C++ struct to JSON, JSON Schema, documentation and hash, all from one declaration.
//
// A parameter's C++ type says what its JSON looks like:
//   bool, int, std::int64_t, std::uint32_t, double    a boolean or number
//   std::string                                       text
//   FilePath                                          a path, relative to the graph file
//   Color                                             [r, g, b], a number for grey, or {"space": "srgb", "value": [r, g, b]}
//   enum E with choices(E)                            one of the choices' texts
//   glm::dvec2/3/4, glm::ivec2, std::array<T, N>      an array of that length
//   glm::dmat4                                        four rows of four, as on a blackboard
//   std::vector<T>, std::optional<T>                  an array; null or a T
//   a struct S with describe(Fields<S>&)              an object; unknown keys are errors
// describe() is found by argument-dependent look-up, beside the struct:
//   inline void describe(Fields<Rotate>& f) { f.field("axis", &Rotate::axis, "Axis through the origin."); }
#pragma once

#include "runtime/core/diagnostic.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace frustum {

// A file named by a graph: as written, and where it is.
struct FilePath {
  std::string written = {};   // as the graph says it, for messages
  std::string resolved = {};  // absolute or relative to the process; empty where nothing was written
  bool empty() const { return written.empty(); }
};

// Linear light with Rec.709 primaries, whatever space it was written in.
struct Color {
  glm::dvec3 rgb{0};
};

struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool open_low = false, open_high = false;  // whether the end itself is excluded
  bool holds(double v) const { return (open_low ? v > low : v >= low) && (open_high ? v < high : v <= high); }
};
inline Range at_least(double low) { return {.low = low}; }
inline Range above(double low) { return {.low = low, .open_low = true}; }
inline Range between(double low, double high) { return {.low = low, .high = high}; }

struct ParamOptions {
  std::string_view unit = {};  // "px", "degrees", "w"; empty for a pure number
  Range range = {};            // holds for every number inside an array
};

// A parameter that trades accuracy for time, or for something else: what `frustum sweep` turns.
struct Knob {
  std::vector<std::string> values = {};  // as --set takes them, from cheap to exact; at least two
  std::string basis = {};                // what is traded, and why the slope is what it is: one sentence
  std::optional<double> slope = {};      // of log(error) over log(value), where theory has one; numbers only
  bool taste = false;  // other values are another picture, not a worse one: swept only where it is asked for
};

struct ParamType;

struct ParamField {
  std::string name;
  std::string doc;
  ParamOptions options;
  const ParamType* type = nullptr;
  std::size_t offset = 0;  // of the member in its struct
  std::optional<Knob> knob = {};
};

// Reads with diagnostics instead of exceptions; knows where in the document it is.
class ParamReader {
 public:
  // `folder`: what relative file paths start from. `to_linear`: converts a colour from a named space to linear Rec.709,
  // false where it does not know the space.
  using ToLinear = std::function<bool(std::string_view space, glm::dvec3& rgb)>;
  ParamReader(Diagnostics& problems, std::string pointer, std::string folder, ToLinear to_linear = {});

  void problem(std::string code, std::string message, std::string expected = {}, std::string got = {},
               std::vector<std::string> suggestions = {});
  const std::string& pointer() const { return pointer_; }
  const std::string& folder() const { return folder_; }
  const ToLinear& to_linear() const { return to_linear_; }
  std::size_t problems() const { return problems_.size(); }

  // Runs `body` with the pointer one level deeper.
  void inside(std::string_view key, const std::function<void()>& body);
  void inside(std::size_t index, const std::function<void()>& body);

 private:
  Diagnostics& problems_;
  std::string pointer_, folder_;
  ToLinear to_linear_;
};

// What a parameter's JSON looks like, and the two ways between it and the C++ value.
struct ParamType {
  enum class Kind { boolean, integer, real, text, file, color, choice, array, matrix, optional, record };

  Kind kind;
  std::string name;                    // for messages: "a number", "an array of 3 numbers"
  const ParamType* element = nullptr;  // array, optional
  std::size_t count = 0;               // array: its length, 0 for any
  std::vector<std::string> choices = {};
  std::vector<ParamField> fields = {};  // record
  bool exactly_one = false;             // record: exactly one field, such as one step of a transform

  // Reads into `value`, leaving the default where the JSON is wrong, which is then reported.
  std::function<void(const Json&, void* value, const ParamOptions&, ParamReader&)> read = {};
  std::function<Json(const void* value)> write = {};
  // Calls `visit` for every FilePath inside; empty for types that hold none.
  std::function<void(const void* value, const std::function<void(const FilePath&)>& visit)> files = {};
};

// Draft 2020-12 JSON Schema of a type; `defaults` is null or points to a default value.
Json json_schema(const ParamType&, const ParamOptions&, const void* defaults);

// Reads the members of an object into the struct at `value`; a key that is no field is reported with its nearest name.
void read_record(const ParamType&, const Json&, void* value, ParamReader&);
Json write_record(const ParamType&, const void* value);

template <class T>
const ParamType& param_type();

template <class S>
class Fields {
 public:
  template <class M>
  Fields& field(std::string_view name, M S::*member, std::string_view doc, ParamOptions options = {}) {
    static const S probe{};
    const auto offset =
        reinterpret_cast<const char*>(&(probe.*member)) - reinterpret_cast<const char*>(&probe);
    type_.fields.push_back({std::string(name),
                            std::string(doc),
                            options,
                            &param_type<M>(),
                            static_cast<std::size_t>(offset),
                            {}});
    return *this;
  }
  // Makes the field that was described last a knob.
  Fields& knob(Knob k) {
    type_.fields.back().knob = std::move(k);
    return *this;
  }
  // Of all fields (each an optional) exactly one is written.
  Fields& exactly_one() {
    type_.exactly_one = true;
    return *this;
  }
  const ParamType& type() const { return type_; }
  ParamType take() { return std::move(type_); }

  ParamType type_{.kind = ParamType::Kind::record, .name = "an object"};
};

}  // namespace frustum

#include "runtime/core/param_types.h"
