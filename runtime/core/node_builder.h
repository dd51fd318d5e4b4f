// node() and pixel_node(): from typed structs and functions to a NodeType. Included by node_type.h only.
#pragma once

namespace frustum {
namespace detail {

// How one member of Inputs or Outputs is a port. `alternatives` are the buffer kinds it takes.
template <class M>
struct PortOf;

template <class T>
struct PortOf<Ref<T>> {
  static constexpr bool list = false, optional = false, tiled = false;
  static std::vector<const BufferType*> types() { return {&buffer_type<T>()}; }
  static void set(Ref<T>& m, std::span<const Buffer> from, const TiledInput&) { m = from.front().as<T>(); }
  static Buffer get(const Ref<T>& m) { return m ? Buffer(m) : Buffer(); }
};

template <class T>
struct PortOf<Tiled<T>> {
  static constexpr bool list = false, optional = false, tiled = true;
  static std::vector<const BufferType*> types() { return {&buffer_type<T>()}; }
  static void set(Tiled<T>& m, std::span<const Buffer>, const TiledInput& in) {
    m = Tiled<T>(in.frame, in.planes_read);
  }
};

template <class T>
struct PortOf<std::vector<Ref<T>>> : PortOf<Ref<T>> {
  static constexpr bool list = true;
  static void set(std::vector<Ref<T>>& m, std::span<const Buffer> from, const TiledInput&) {
    m.reserve(from.size());
    for (const Buffer& b : from) m.push_back(b.as<T>());
  }
};

template <class P>
struct PortOf<std::optional<P>> : PortOf<P> {
  static constexpr bool optional = true;
  static void set(std::optional<P>& m, std::span<const Buffer> from, const TiledInput& in) {
    PortOf<P>::set(m.emplace(), from, in);
  }
  static Buffer get(const std::optional<P>& m) { return m ? PortOf<P>::get(*m) : Buffer(); }
};

template <class... T>
struct PortOf<std::variant<Ref<T>...>> {
  static constexpr bool list = false, optional = false, tiled = false;
  static std::vector<const BufferType*> types() { return {&buffer_type<T>()...}; }
  static void set(std::variant<Ref<T>...>& m, std::span<const Buffer> from, const TiledInput&) {
    const Buffer& b = from.front();
    ((b.is<T>() ? void(m = b.as<T>()) : void()), ...);
  }
  static Buffer get(const std::variant<Ref<T>...>& m) {
    return std::visit([](const auto& ref) { return ref ? Buffer(ref) : Buffer(); }, m);
  }
};

// The number of members of an aggregate, found by initialising it with ever more values that convert to anything.
struct Anything {
  template <class T>
  operator T() const;
};
template <class T, class... A>
constexpr std::size_t member_count(A... a) {
  if constexpr (requires { T{a..., Anything{}}; })
    return member_count<T>(a..., Anything{});
  else
    return sizeof...(A);
}

template <class S, class M>
std::size_t offset_in(M S::*member) {
  static const S probe{};
  return static_cast<std::size_t>(reinterpret_cast<const char*>(&(probe.*member)) -
                                  reinterpret_cast<const char*>(&probe));
}

template <class S>
using SetPort = void (*)(S&, std::size_t offset, std::span<const Buffer>, const TiledInput&);
template <class S>
using GetPort = Buffer (*)(const S&, std::size_t offset);

template <class M, class S>
M& member_at(S& s, std::size_t offset) {
  return *reinterpret_cast<M*>(reinterpret_cast<char*>(&s) + offset);
}
template <class M, class S>
const M& member_at(const S& s, std::size_t offset) {
  return *reinterpret_cast<const M*>(reinterpret_cast<const char*>(&s) + offset);
}

}  // namespace detail

template <class I, class P, class O>
class NodeBuilder {
 public:
  explicit NodeBuilder(std::string_view name) {
    type_.name = name;
    type_.input_members = detail::member_count<I>();
    type_.output_members = detail::member_count<O>();
    type_.param_members = detail::member_count<P>();
    type_.default_params = [] { return std::static_pointer_cast<void>(std::make_shared<P>()); };
  }

  NodeBuilder& doc(std::string_view sentence) { return type_.doc = sentence, *this; }
  NodeBuilder& cite(std::string_view source) { return type_.citations.emplace_back(source), *this; }
  template <class... Rows>
  NodeBuilder& covers(Rows... rows) {
    return type_.rows = {rows...}, *this;
  }
  NodeBuilder& version(int n) { return type_.version = n, *this; }
  NodeBuilder& foreign() { return type_.foreign = true, *this; }

  template <class M>
  NodeBuilder& input(std::string_view name, M I::*member, std::string_view doc, PortOptions options = {}) {
    type_.inputs.push_back(port<I>(name, member, doc, options));
    set_.push_back([](I& in, std::size_t at, std::span<const Buffer> from, const TiledInput& tiled) {
      detail::PortOf<M>::set(detail::member_at<M>(in, at), from, tiled);
    });
    return *this;
  }
  template <class M>
  NodeBuilder& param(std::string_view name, M P::*member, std::string_view doc, ParamOptions options = {}) {
    fields_.field(name, member, doc, options);
    return *this;
  }
  // The parameter described last trades accuracy for time: `order` from cheap to exact.
  NodeBuilder& knob(std::initializer_list<std::string_view> order, std::string_view basis,
                    std::optional<double> slope = {}) {
    return fields_.knob({{order.begin(), order.end()}, std::string(basis), slope, false}), *this;
  }
  // Its values make other pictures, none of them wrong: swept only where it is asked for.
  NodeBuilder& knob_of_taste(std::initializer_list<std::string_view> order, std::string_view basis) {
    return fields_.knob({{order.begin(), order.end()}, std::string(basis), {}, true}), *this;
  }
  // Finds what is wrong with the parameters whatever the inputs are, when the graph is loaded and before run() or
  // prepare(), which need not look again: throws NodeError(code, sentence, at_param(...)).
  NodeBuilder& check(void (*check)(const P&)) {
    type_.check = [check](const void* params) { check(*static_cast<const P*>(params)); };
    return *this;
  }
  // What holds for other nodes because of the parameters, in a sentence that `frustum plan` shows.
  NodeBuilder& states(std::string (*sentence)(const P&)) {
    type_.states = [sentence](const void* params) { return sentence(*static_cast<const P*>(params)); };
    return *this;
  }
  template <class M>
  NodeBuilder& output(std::string_view name, M O::*member, std::string_view doc, PortOptions options = {}) {
    type_.outputs.push_back(port<O>(name, member, doc, options));
    if constexpr (detail::PortOf<M>::tiled)
      frame_.push_back([](const O& o, std::size_t at) { return detail::member_at<M>(o, at).shared_frame(); });
    else
      get_.push_back(
          [](const O& o, std::size_t at) { return detail::PortOf<M>::get(detail::member_at<M>(o, at)); });
    return *this;
  }
  // Work that is not done where `needed` finds that it would change no bit of the result; run() and prepare() ask
  // ctx.simulates(name).
  NodeBuilder& effect(std::string_view name, Verdict (*needed)(const I&, const P&, const Context&),
                      std::string_view doc, EffectCost cost = {}) {
    type_.effects.push_back({std::string(name), std::string(doc), false, cost});
    needed_.push_back(needed);
    return *this;
  }
  // Work that is saved where `needed` finds that the final picture does not depend on it.
  NodeBuilder& shortcut(std::string_view name, Verdict (*needed)(const I&, const P&, const Context&),
                        std::string_view doc, EffectCost cost = {}) {
    effect(name, needed, doc, cost);
    type_.effects.back().shortcut = true;
    return *this;
  }
  // How far tile() looks beyond the rectangle it fills; without it, not at all.
  template <class State>
  NodeBuilder& reads(Rect (*f)(const State&, std::string_view input, Rect)) {
    reads_ = [f](const void* state, std::string_view input, Rect r) {
      return f(*static_cast<const State*>(state), input, r);
    };
    return *this;
  }

  // A part of `rect` (any part of the outputs' window) outside of which tile() finds nothing: no face at any sample.
  template <class State>
  NodeBuilder& seen(Rect (*f)(const State&, Rect rect)) {
    type_.seen = [f](const void* state, Rect rect) { return f(*static_cast<const State*>(state), rect); };
    return *this;
  }
  // All outputs are 0, and no_face in planes of integers, wherever this input is so or sees no face, throughout what
  // reads() names. tile() is then called for what may show something only, and the rest is filled for those who read it.
  template <class M>
  NodeBuilder& blank_where(M I::*member) {
    const std::size_t offset = detail::offset_in(member);
    for (std::size_t i = 0; i < type_.inputs.size(); ++i)
      if (type_.inputs[i].offset == offset) type_.blank_where = i;
    return *this;
  }

  void geometry(O (*run)(const I&, const P&, Context&)) { run_ = run; }
  template <class State>
  void pixel(Prepared<State, O> (*prepare)(const I&, const P&, Context&),
             void (*tile)(const State&, const TilesOf<I>&, const TilesOf<O>&, Arena&)) {
    prepare_ = [prepare](const I& in, const P& p, Context& ctx) {
      Prepared<State, O> made = prepare(in, p, ctx);
      return std::pair<std::shared_ptr<const void>, O>(std::make_shared<const State>(std::move(made.state)),
                                                       std::move(made.outputs));
    };
    tile_ = [tile](const void* state, const TilesOf<I>& in, const TilesOf<O>& out, Arena& arena) {
      tile(*static_cast<const State*>(state), in, out, arena);
    };
  }

  operator NodeType() {
    type_.params = detail::record_type(fields_.take());
    // An input left out keeps its member's default.
    const auto fill = [ports = type_.inputs, set = set_](I& in, std::size_t i, std::span<const Buffer> from,
                                                         const TiledInput& tiled) {
      if (!from.empty() || tiled.frame) set[i](in, ports[i].offset, from, tiled);
    };
    const auto decide = [effects = type_.effects, needed = needed_, check = type_.check](
                            const I& in, const P& p, Context& ctx) {
      if (check) check(&p);
      for (std::size_t i = 0; i < effects.size(); ++i) ctx.decide(effects[i].name, needed[i](in, p, ctx));
    };
    if (run_ != nullptr) {
      type_.run = [fill, decide, run = run_, ports = type_.outputs, get = get_](
                      std::span<const std::vector<Buffer>> inputs, const void* params, Context& ctx) {
        I in{};
        for (std::size_t i = 0; i < inputs.size(); ++i) fill(in, i, inputs[i], {});
        decide(in, *static_cast<const P*>(params), ctx);
        const O out = run(in, *static_cast<const P*>(params), ctx);
        std::vector<Buffer> buffers;
        buffers.reserve(ports.size());
        for (std::size_t i = 0; i < ports.size(); ++i) buffers.push_back(get[i](out, ports[i].offset));
        return buffers;
      };
    } else {
      type_.prepare = [fill, decide, prepare = prepare_, ports = type_.outputs, frame = frame_](
                          std::span<const PreparedInput> inputs, const void* params, Context& ctx) {
        I in{};
        for (std::size_t i = 0; i < inputs.size(); ++i) fill(in, i, inputs[i].buffers, inputs[i].tiled);
        decide(in, *static_cast<const P*>(params), ctx);
        auto [state, out] = prepare(in, *static_cast<const P*>(params), ctx);
        PreparedNode made{std::move(state), {}};
        for (std::size_t i = 0; i < ports.size(); ++i) made.frames.push_back(frame[i](out, ports[i].offset));
        return made;
      };
      std::vector<std::size_t> in_offsets, out_offsets;
      std::vector<std::string> names;
      for (const Port& p : type_.inputs) in_offsets.push_back(p.offset), names.push_back(p.name);
      for (const Port& p : type_.outputs) out_offsets.push_back(p.offset);
      type_.tile = [tile = tile_, in_offsets, out_offsets](const void* state, std::span<const Tile> in,
                                                           std::span<const Tile> out, Arena& arena) {
        tile(state, TilesOf<I>(in, in_offsets), TilesOf<O>(out, out_offsets), arena);
      };
      type_.reads = [reads = reads_, names](const void* state, std::size_t input, Rect rect) {
        return reads ? reads(state, names[input], rect) : rect;
      };
    }
    return std::move(type_);
  }

 private:
  template <class S, class M>
  static Port port(std::string_view name, M S::*member, std::string_view doc, PortOptions options) {
    using Of = detail::PortOf<M>;
    return {std::string(name), std::string(doc), Of::types(),   Of::list,
            Of::optional,      Of::tiled,        options.space, detail::offset_in(member)};
  }

  NodeType type_;
  Fields<P> fields_;
  std::vector<Verdict (*)(const I&, const P&, const Context&)> needed_;
  std::vector<detail::SetPort<I>> set_;
  std::vector<detail::GetPort<O>> get_;
  std::vector<std::shared_ptr<const Frame> (*)(const O&, std::size_t)> frame_;
  O (*run_)(const I&, const P&, Context&) = nullptr;
  std::function<std::pair<std::shared_ptr<const void>, O>(const I&, const P&, Context&)> prepare_;
  std::function<void(const void*, const TilesOf<I>&, const TilesOf<O>&, Arena&)> tile_;
  std::function<Rect(const void*, std::string_view, Rect)> reads_;
};

// A node that maps whole buffers to whole buffers.
template <class I, class P, class O>
NodeBuilder<I, P, O> node(std::string_view name, O (*run)(const I&, const P&, Context&)) {
  NodeBuilder<I, P, O> b(name);
  b.geometry(run);
  return b;
}

// A node that fills rectangles of pixels.
template <class I, class P, class O, class State>
NodeBuilder<I, P, O> pixel_node(std::string_view name,
                                Prepared<State, O> (*prepare)(const I&, const P&, Context&),
                                void (*tile)(const State&, const TilesOf<I>&, const TilesOf<O>&, Arena&)) {
  NodeBuilder<I, P, O> b(name);
  b.pixel(prepare, tile);
  return b;
}

}  // namespace frustum
