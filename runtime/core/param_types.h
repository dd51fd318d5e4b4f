// param_type<T>() for every C++ type a parameter may have. Included by param.h only.
#pragma once

namespace frustum {
namespace detail {

// How a number of some C++ type is stored; `store` says whether the value fits.
struct IntegerAccess {
  bool (*store)(void*, std::int64_t);
  std::int64_t (*load)(const void*);
  std::int64_t low, high;
};
struct ChoiceAccess {
  void (*store)(void*, std::size_t index);
  std::size_t (*load)(const void*);
};
struct ArrayAccess {
  void (*resize)(void*, std::size_t);  // null where the length is fixed
  std::size_t (*size)(const void*);
  void* (*at)(void*, std::size_t);
};
struct OptionalAccess {
  void* (*emplace)(void*);
  void (*reset)(void*);
  const void* (*get)(const void*);  // null where there is no value
};

ParamType boolean_type();
ParamType real_type();
ParamType text_type();
ParamType file_type();
ParamType color_type();
ParamType matrix_type();
ParamType integer_type(IntegerAccess);
ParamType choice_type(std::vector<std::string> names, ChoiceAccess);
ParamType array_type(const ParamType& element, std::size_t count, ArrayAccess);
ParamType optional_type(const ParamType& element, OptionalAccess);
ParamType record_type(ParamType fields);

template <class T>
struct Array : std::false_type {};
template <class T>
struct Array<std::vector<T>> : std::true_type {
  using element = T;
  static constexpr std::size_t count = 0;
};
template <class T, std::size_t n>
struct Array<std::array<T, n>> : std::true_type {
  using element = T;
  static constexpr std::size_t count = n;
};
template <glm::length_t n, class T, glm::qualifier q>
struct Array<glm::vec<n, T, q>> : std::true_type {
  using element = T;
  static constexpr std::size_t count = n;
};

template <class T>
struct Optional : std::false_type {};
template <class T>
struct Optional<std::optional<T>> : std::true_type {
  using element = T;
};

template <class T>
void* element_at(void* array, std::size_t i) {
  auto& a = *static_cast<T*>(array);
  if constexpr (requires { a.data(); })
    return a.data() + i;
  else
    return &a[static_cast<glm::length_t>(i)];
}

template <class T>
ParamType make_array_type() {
  using A = Array<T>;
  ArrayAccess access{nullptr, [](const void*) { return A::count; }, element_at<T>};
  if constexpr (A::count == 0) {
    access.resize = [](void* v, std::size_t n) { static_cast<T*>(v)->resize(n); };
    access.size = [](const void* v) { return static_cast<const T*>(v)->size(); };
  }
  return array_type(param_type<typename A::element>(), A::count, access);
}

template <class T>
ParamType make_choice_type() {
  constexpr auto known = choices(T{});
  std::vector<std::string> names;
  for (const auto& [value, name] : known) names.emplace_back(name);
  return choice_type(std::move(names),
                     {[](void* v, std::size_t i) { *static_cast<T*>(v) = choices(T{})[i].first; },
                      [](const void* v) {
                        std::size_t i = 0;
                        for (const auto& [value, name] : choices(T{})) {
                          if (value == *static_cast<const T*>(v)) break;
                          ++i;
                        }
                        return i;
                      }});
}

template <class T>
ParamType make_integer_type() {
  using Limits = std::numeric_limits<T>;
  return integer_type({[](void* v, std::int64_t i) {
                         if (!std::in_range<T>(i)) return false;
                         *static_cast<T*>(v) = static_cast<T>(i);
                         return true;
                       },
                       [](const void* v) { return static_cast<std::int64_t>(*static_cast<const T*>(v)); },
                       static_cast<std::int64_t>(Limits::min()),
                       std::in_range<std::int64_t>(Limits::max())
                           ? static_cast<std::int64_t>(Limits::max())
                           : std::numeric_limits<std::int64_t>::max()});
}

template <class T>
ParamType make_optional_type() {
  using E = typename Optional<T>::element;
  return optional_type(param_type<E>(), {[](void* v) -> void* { return &static_cast<T*>(v)->emplace(); },
                                         [](void* v) { static_cast<T*>(v)->reset(); },
                                         [](const void* v) -> const void* {
                                           const auto& o = *static_cast<const T*>(v);
                                           return o ? &*o : nullptr;
                                         }});
}

template <class T>
ParamType make_type() {
  if constexpr (std::same_as<T, bool>)
    return boolean_type();
  else if constexpr (std::same_as<T, double>)
    return real_type();
  else if constexpr (std::same_as<T, std::string>)
    return text_type();
  else if constexpr (std::same_as<T, FilePath>)
    return file_type();
  else if constexpr (std::same_as<T, Color>)
    return color_type();
  else if constexpr (std::same_as<T, glm::dmat4>)
    return matrix_type();
  else if constexpr (std::integral<T>)
    return make_integer_type<T>();
  else if constexpr (std::is_enum_v<T>)
    return make_choice_type<T>();
  else if constexpr (Array<T>::value)
    return make_array_type<T>();
  else if constexpr (Optional<T>::value)
    return make_optional_type<T>();
  else {
    Fields<T> fields;
    describe(fields);
    return record_type(fields.take());
  }
}

}  // namespace detail

template <class T>
const ParamType& param_type() {
  static const ParamType type = detail::make_type<T>();
  return type;
}

}  // namespace frustum
