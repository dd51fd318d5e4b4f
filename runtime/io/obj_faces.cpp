#include "runtime/io/obj_faces.h"

#include <algorithm>

namespace frustum::obj {
namespace {

// Numbers from 0 in the order of first use; the last one asked for is found at once.
template <class Key>
class Numbers {
 public:
  std::uint32_t operator()(const Key& key) {
    if (last_ == numbers_.end() || last_->first != key)
      last_ = numbers_.try_emplace(key, static_cast<std::uint32_t>(numbers_.size())).first;
    return last_->second;
  }
  const std::map<Key, std::uint32_t>& all() const { return numbers_; }

 private:
  std::map<Key, std::uint32_t> numbers_;
  typename std::map<Key, std::uint32_t>::iterator last_ = numbers_.end();
};

}  // namespace

template <class R>
FaceNames name_faces(std::span<const Chunk<R>> chunks, std::size_t triangles) {
  bool named[3] = {};
  for (const Chunk<R>& c : chunks)
    for (const FaceChange& change : c.changes) named[change.kind] = true;
  const bool grouped = named[FaceChange::group] || named[FaceChange::object];
  FaceNames out;
  if (!named[FaceChange::material] && !grouped) return out;
  auto material = Column::make<std::uint32_t>("material", Domain::face, triangles);
  auto group = Column::make<std::uint32_t>("group", Domain::face, triangles);
  Numbers<std::string_view> materials;
  Numbers<std::pair<std::string_view, std::string_view>> groups;
  std::string_view now[3];
  std::size_t at = 0;
  for (const Chunk<R>& c : chunks) {
    auto change = c.changes.begin();
    for (std::size_t f = 0; f < c.sizes.size(); ++f) {
      for (; change != c.changes.end() && change->face <= f; ++change) now[change->kind] = change->name;
      const std::uint32_t m = materials(now[FaceChange::material]),
                          g = groups({now[FaceChange::object], now[FaceChange::group]});
      for (std::uint32_t k = 2; k < c.sizes[f]; ++k, ++at)
        material->values<std::uint32_t>()[at] = m, group->values<std::uint32_t>()[at] = g;
    }
    for (; change != c.changes.end(); ++change) now[change->kind] = change->name;
  }
  out.materials.resize(materials.all().size());
  for (const auto& [name, number] : materials.all()) out.materials[number] = name;
  if (named[FaceChange::material]) out.material = std::move(material);
  if (groups.all().size() > 1) out.group = std::move(group);
  return out;
}
template FaceNames name_faces(std::span<const Chunk<float>>, std::size_t);
template FaceNames name_faces(std::span<const Chunk<double>>, std::size_t);

}  // namespace frustum::obj
