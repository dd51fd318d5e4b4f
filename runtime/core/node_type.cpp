#include "runtime/core/node_type.h"

#include <cstdlib>
#include <new>

namespace frustum {
namespace {

std::optional<std::size_t> find(const std::vector<Port>& ports, std::string_view name) {
  for (std::size_t i = 0; i < ports.size(); ++i)
    if (ports[i].name == name) return i;
  return std::nullopt;
}

constexpr std::size_t alignment = 64;  // a cache line, and the widest vector

std::size_t aligned(std::size_t size) { return (size + alignment - 1) / alignment * alignment; }

}  // namespace

std::optional<std::size_t> NodeType::find_input(std::string_view port) const { return find(inputs, port); }
std::optional<std::size_t> NodeType::find_output(std::string_view port) const { return find(outputs, port); }

void* Arena::take_bytes(std::size_t size) {
  size = aligned(std::max<std::size_t>(size, 1));
  if (blocks_.empty() || used_ + size > blocks_.back().size) {
    const std::size_t block = std::max<std::size_t>(size, 64 * 1024);
    auto* data = static_cast<std::byte*>(std::aligned_alloc(alignment, block));
    if (data == nullptr) throw std::bad_alloc();
    blocks_.push_back({{data, [](std::byte* p) { std::free(p); }}, block});
    used_ = 0;
  }
  void* p = blocks_.back().data.get() + used_;
  used_ += size;
  return p;
}

// Keeps one block that would have held everything, so that a warm arena allocates nothing.
void Arena::reset() {
  if (blocks_.size() > 1) {
    const std::size_t total = capacity();
    blocks_.clear();
    used_ = 0;
    take_bytes(total);
  }
  used_ = 0;
}

std::size_t Arena::capacity() const {
  std::size_t sum = 0;
  for (const Block& b : blocks_) sum += b.size;
  return sum;
}

}  // namespace frustum
