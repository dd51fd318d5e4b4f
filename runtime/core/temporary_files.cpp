#include "runtime/core/temporary_files.h"

#include <unistd.h>

#include <atomic>
#include <cstring>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace frustum {
namespace {

// Links stay for ever, in lists that only grow, so that a handler can walk them at any moment.
template <class T>
struct Link {
  T value{};
  Link* next = nullptr;
};
template <class T>
using List = std::atomic<Link<T>*>;

template <class T>
void push(List<T>& list, Link<T>* link) {
  link->next = list.load();
  while (!list.compare_exchange_weak(link->next, link)) {
  }
}

// Whoever takes the name out of a slot may use it; a handler's is never freed.
using Slot = Link<std::atomic<char*>>;
List<std::atomic<char*>> slots{nullptr};
List<RemoveTemporaryFiles> modules{nullptr};
static_assert(std::atomic<char*>::is_always_lock_free && std::atomic<Slot*>::is_always_lock_free,
              "a signal handler may touch nothing else");

struct Name {
  Slot* slot;
  std::unique_ptr<char[]> text;
};
struct Registry {
  std::mutex mutex;
  std::unordered_map<std::string, Name> used;
  std::vector<Slot*> empty;
  std::vector<std::unique_ptr<char[]>> taken;  // by a handler
};
// Never destroyed: files may still be written while the process ends.
Registry& registry() {
  static auto& all = *new Registry;
  return all;
}

}  // namespace

void remember_temporary_file(const std::string& path) {
  auto& [mutex, used, empty, taken] = registry();
  const std::lock_guard lock(mutex);
  if (used.contains(path)) return;
  if (empty.empty()) {
    empty.push_back(new Slot);
    push(slots, empty.back());
  }
  Name name{empty.back(), std::make_unique<char[]>(path.size() + 1)};
  std::memcpy(name.text.get(), path.c_str(), path.size() + 1);
  const auto entry = used.emplace(path, std::move(name)).first;
  empty.pop_back();
  entry->second.slot->value.store(entry->second.text.get());
}

void forget_temporary_file(const std::string& path) {
  auto& [mutex, used, empty, taken] = registry();
  const std::lock_guard lock(mutex);
  const auto entry = used.find(path);
  if (entry == used.end()) return;
  auto& [slot, text] = entry->second;
  if (slot->value.exchange(nullptr) == nullptr) taken.push_back(std::move(text));
  empty.push_back(slot);
  used.erase(entry);
}

void remove_temporary_files() noexcept {
  for (Slot* slot = slots.load(); slot != nullptr; slot = slot->next)
    if (const char* name = slot->value.exchange(nullptr); name != nullptr) unlink(name);
  for (const auto* module = modules.load(); module != nullptr; module = module->next) module->value();
}

void include_temporary_files(RemoveTemporaryFiles of_module) {
  push(modules, new Link<RemoveTemporaryFiles>{of_module});
}

}  // namespace frustum
