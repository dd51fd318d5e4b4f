#include "runtime/core/temporary_files.h"

#include <unistd.h>

#include <atomic>
#include <cstring>
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

// Whoever takes the name out of a slot owns it.
using Slot = Link<std::atomic<char*>>;
List<std::atomic<char*>> slots{nullptr};
List<RemoveTemporaryFiles> modules{nullptr};
static_assert(std::atomic<char*>::is_always_lock_free && std::atomic<Slot*>::is_always_lock_free,
              "a signal handler may touch nothing else");

struct Registry {
  std::mutex mutex;
  std::unordered_map<std::string, Slot*> used;
  std::vector<Slot*> empty;
};
// Never destroyed: files may still be written while the process ends.
Registry& registry() {
  static auto& all = *new Registry;
  return all;
}

}  // namespace

void remember_temporary_file(const std::string& path) {
  auto& [mutex, used, empty] = registry();
  const std::lock_guard lock(mutex);
  const auto [entry, added] = used.try_emplace(path, nullptr);
  if (!added) return;
  if (empty.empty()) {
    empty.push_back(new Slot);
    push(slots, empty.back());
  }
  entry->second = empty.back();
  empty.pop_back();
  auto* name = new char[path.size() + 1];
  std::memcpy(name, path.c_str(), path.size() + 1);
  entry->second->value.store(name);
}

void forget_temporary_file(const std::string& path) {
  auto& [mutex, used, empty] = registry();
  const std::lock_guard lock(mutex);
  const auto entry = used.find(path);
  if (entry == used.end()) return;
  delete[] entry->second->value.exchange(nullptr);  // null where a handler has the name: it is not freed then
  empty.push_back(entry->second);
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
