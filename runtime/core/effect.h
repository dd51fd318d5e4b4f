// Work that a scene may not call for, and what is decided about it.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace frustum {

// Whether a node's inputs call for one of its effects.
struct Verdict {
  enum class Kind : std::uint8_t {
    on,         // `why` names a witness: what in the scene needs it
    off_exact,  // `why` is a certificate: the facts that make its contribution the identity, bit for bit
    off_user,   // the graph or the command line asks not to have it
    absent,     // the scene calls for it, and nothing in the graph simulates it
  };
  Kind kind = Kind::on;
  std::string why = {};
  std::uint64_t items =
      0;  // how many of the effect's items (EffectCost) it is or would be done for; 0: not known
};
constexpr auto choices(Verdict::Kind) {
  using Kind = Verdict::Kind;
  return std::array{std::pair{Kind::on, "on"}, std::pair{Kind::off_exact, "off_exact"},
                    std::pair{Kind::off_user, "off_user"}, std::pair{Kind::absent, "absent"}};
}

inline Verdict on(std::string witness, std::uint64_t items = 0) {
  return {Verdict::Kind::on, std::move(witness), items};
}
inline Verdict off_exact(std::string certificate, std::uint64_t items = 0) {
  return {Verdict::Kind::off_exact, std::move(certificate), items};
}
inline Verdict off_user(std::string wish) { return {Verdict::Kind::off_user, std::move(wish), 0}; }
inline Verdict absent(std::string witness) { return {Verdict::Kind::absent, std::move(witness), 0}; }

// What an effect costs where it is on, from which the plan estimates its time. `ns` was measured, in one thread.
struct EffectCost {
  std::string_view item;  // "face", "sample": what Verdict::items counts
  double ns = 0;          // for one of them
};

// What is said about an effect where the node type is declared.
struct EffectDoc {
  std::string name;       // "clipping"
  std::string doc;        // one sentence: what is not done where the effect is off
  bool shortcut = false;  // not doing it would change the result elsewhere; here it is licensed
  EffectCost cost = {};   // no item: not measured
};

// What a run asks of effects beyond what the scene does. Forced: simulated although the scene does not call for
// it, which by the certificate changes nothing. Skipped: not simulated although it may, which may change
// everything. Names are those of effects.
struct EffectPolicy {
  bool force_all = false;
  std::set<std::string, std::less<>> forced = {}, skipped = {};

  bool forces(std::string_view name) const { return force_all || forced.contains(name); }
  bool skips(std::string_view name) const { return skipped.contains(name); }
  bool any() const { return force_all || !forced.empty() || !skipped.empty(); }
};

}  // namespace frustum
