// The folder that keeps buffers: whatever happens to its files, a run gets the right bytes or computes them.
#include "runtime/graph/disk_cache.h"

#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/surface.h"
#include "runtime/buffers/texture.h"
#include "runtime/buffers/value.h"
#include "runtime/core/error.h"
#include "runtime/graph/keys.h"
#include "tests/support/pixel_nodes.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>

#include <sys/mount.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <set>
#include <thread>

namespace frustum::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Digest key(int i) { return Hasher().text("test").value(i).done(); }

Buffer mesh_of(std::uint32_t faces, double height = 0) {
  Mesh m;
  auto position = Column::make<glm::vec3>("position", Domain::vertex, std::size_t{3} * faces, Space::world);
  auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, faces);
  for (std::uint32_t f = 0; f < faces; ++f) {
    for (std::uint32_t c = 0; c < 3; ++c)
      position->values<glm::vec3>()[3 * f + c] = glm::vec3(f + c, c / 2, height);
    triangle->values<glm::uvec3>()[f] = {3 * f, 3 * f + 1, 3 * f + 2};
  }
  m.columns = {position, triangle};
  m.materials = std::make_shared<const MaterialSet>(MaterialSet{{Material{.name = "clay"}, Material{}}});
  m.camera = std::make_shared<const Camera>(Camera{.far_z = std::numeric_limits<double>::infinity()});
  m.closed = false;
  return std::make_shared<const Mesh>(std::move(m));
}

Frame sampled_frame(int width, int height) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = 2;
  pattern->x = {100, 4000}, pattern->y = {2048, 7};
  Frame f;
  f.window = {-3, 2, width - 3, height + 2};
  f.pattern = pattern;
  f.planes = {{"R", PlaneKind::f32}, {"P.x", PlaneKind::f64}, {"id", PlaneKind::u32}};
  f.color_space = "lin_rec709";
  f.alpha = Alpha::premultiplied;
  return f;
}

template <class Kind>
Buffer picture(int width = 37, int height = 11) {
  Raster r(sampled_frame(width, height));
  const Tile t = r.view();
  for (int s = 0; s < 2; ++s)
    for (int y = t.rect().y0; y < t.rect().y1; ++y)
      for (int i = 0; i < width; ++i) {
        t.row<float>(0, s, y)[i] = static_cast<float>(i * y + s) / 7;
        t.row<double>(1, s, y)[i] = i == 5 ? std::numeric_limits<double>::quiet_NaN() : 1.0 / (i + 1);
        t.row<std::uint32_t>(2, s, y)[i] = static_cast<std::uint32_t>(i * s);
      }
  return buffer_type<Kind>().from_raster(r);
}

template <class T>
Buffer made(T value) {
  return std::make_shared<const T>(std::move(value));
}

// One of every kind that has a form on disk, with its odder values.
std::vector<Buffer> one_of_each() {
  Surface surface;
  surface.points = {{1, 2, 3}, {4, 5, -0.0}};
  surface.patches.push_back({0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1});
  SamplePattern pattern;
  pattern.samples = 3, pattern.period = 2;
  pattern.x.assign(12, 5), pattern.y.assign(12, 4095);
  MipPyramid pyramid;
  pyramid.levels = {{2, 1, {1, 2, 3, 4, 5, 6, 7, 8}}, {1, 1, {9, 9, 9, 9}}};
  pyramid.wrap_v = Wrap::mirror, pyramid.alpha_cutoff = 0.5;
  MipPyramid half;
  half.levels = {{2, 1, {}, {0, 0x3C00, 0xBC00, 0x7BFF, 1, 2, 3, 4}}};
  Table table;
  table.columns = {{.name = "edge", .unit = "px", .numbers = {1, 2.5}},
                   {.name = "why", .texts = {"", "a\0b"}}};
  LightSet lights;
  lights.lights.resize(2);
  lights.lights[1].kind = Light::Kind::point;
  lights.lights[1].attenuation = {1, 2, 3};
  Material textured{.name = "brick"};
  textured.emission = {1, 2, 3}, textured.two_sided = true, textured.uv_set = 1;
  textured.texture_from_uv[2][0] = 0.25;
  textured.unlit = true;
  textured.texture = std::make_shared<const Texture>(pyramid);
  Mesh walls = *mesh_of(2).as<Mesh>();
  walls.materials = std::make_shared<const MaterialSet>(MaterialSet{{textured, Material{}, textured}});
  return {mesh_of(5),
          made(Mesh{}),
          picture<Image>(),
          picture<Depth>(),
          picture<Visibility>(),
          made(Image{}),
          made(surface),
          made(pattern),
          made(Texture{pyramid}),
          made(Texture{half}),
          made(Texture{Checker{.scale = 3}}),
          made(table),
          made(lights),
          made(textured),
          made(walls),
          made(Material{.name = "wax", .model = Reflection::phong}),
          made(Camera{.reversed_z = true, .conventions = Conventions::vulkan, .subpixel_bits = 5}),
          made(Number{-0.0}),
          made(Matrix{glm::dmat4(3)})};
}

Buffer load(DiskCache& cache, int i, const Buffer& like) {
  const BufferType* kinds[] = {&like.type()};
  return cache.load(key(i), kinds);
}

std::vector<fs::path> objects(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& e : fs::recursive_directory_iterator(folder + "/objects"))
    if (e.is_regular_file()) files.push_back(e.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_file(const fs::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(DiskCache, GivesEveryKindBackWithItsBytes) {
  const TempFolder folder;
  const std::vector<Buffer> all = one_of_each();
  {
    DiskCache writer(folder.path());
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_EQ(writer.store(key(static_cast<int>(i)), all[i]), DiskCache::Store::stored)
          << all[i].type().name;
  }
  DiskCache reader(folder.path());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Buffer b = load(reader, static_cast<int>(i), all[i]);
    ASSERT_TRUE(b) << all[i].type().name;
    EXPECT_EQ(b.digest(), all[i].digest()) << all[i].type().name;
    EXPECT_EQ(b.bytes(), all[i].bytes()) << all[i].type().name;
  }
  EXPECT_EQ(reader.store(key(0), all[0]), DiskCache::Store::there_already);
  EXPECT_THAT(reader.take_warnings(), IsEmpty());
}

TEST(DiskCache, KeepsAColumnOnceAndSharesItAgain) {
  const TempFolder folder;
  const Buffer first = mesh_of(100);
  Mesh moved = *first.as<Mesh>();
  moved = moved.with(Column::make<glm::vec3>("position", Domain::vertex, 300, Space::eye));
  std::fill_n(const_cast<glm::vec3*>(moved.at("position").values<glm::vec3>().data()), 300, glm::vec3(1));
  const Buffer second = made(moved);
  {
    DiskCache cache(folder.path());
    cache.store(key(1), first);
    cache.store(key(2), second);
  }
  std::size_t columns = 0;
  for (const fs::path& f : objects(folder.path())) columns += f.extension() == ".column" ? 1 : 0;
  EXPECT_EQ(columns, 3u) << "two of position, one of triangle";
  DiskCache cache(folder.path());
  const Buffer a = load(cache, 1, first), b = load(cache, 2, second);
  EXPECT_EQ(a.as<Mesh>()->at("triangle").data(), b.as<Mesh>()->at("triangle").data());
  EXPECT_NE(a.as<Mesh>()->at("position").data(), b.as<Mesh>()->at("position").data());
}

// Every file of a stored mesh and picture is altered in turn; the bytes are right or not there.
template <class Alter>
void expect_never_wrong(Alter&& alter, int rounds) {
  const TempFolder folder;
  const Buffer mesh = mesh_of(40), image = picture<Image>();
  std::mt19937 random(7);
  std::uint64_t misses = 0;
  for (int round = 0; round < rounds; ++round) {
    {
      DiskCache cache(folder.path());
      cache.store(key(1), mesh);
      cache.store(key(2), image);
    }
    const auto files = objects(folder.path());
    ASSERT_THAT(files, SizeIs(4)) << "two buffers and two columns";
    const fs::path& file = files[static_cast<std::size_t>(round) % files.size()];
    const std::string whole = read_file(file);
    const std::string altered = alter(whole, random);
    write_file(file, altered);
    DiskCache cache(folder.path());
    const Buffer a = load(cache, 1, mesh), b = load(cache, 2, image);
    if (a) {
      EXPECT_EQ(a.digest(), mesh.digest());
    }
    if (b) {
      EXPECT_EQ(b.digest(), image.digest());
    }
    const bool missed = !a || !b;
    misses += missed ? 1 : 0;
    EXPECT_EQ(missed, altered != whole) << file;
    EXPECT_EQ(cache.take_warnings().size(), missed ? 1u : 0u);
    EXPECT_EQ(fs::exists(file), !missed) << "what is damaged is removed";
  }
  EXPECT_GT(misses, 0u);
}

TEST(DiskCache, AFlippedBitAnywhereIsAMiss) {
  expect_never_wrong(
      [](std::string bytes, std::mt19937& random) {
        const std::size_t at = random() % bytes.size();
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        return bytes;
      },
      400);
}

TEST(DiskCache, EveryBitOfTheHeaderCounts) {
  int bit = 0;
  expect_never_wrong(
      [&](std::string bytes, std::mt19937&) {
        char& byte = bytes[static_cast<std::size_t>(bit / 8)];
        byte = static_cast<char>(byte ^ (1 << bit % 8));
        bit = (bit + 1) % 512;
        return bytes;
      },
      512);
}

TEST(DiskCache, AFileCutShortOrGrownIsAMiss) {
  expect_never_wrong(
      [](const std::string& bytes, std::mt19937& random) {
        return random() % 4 == 0 ? bytes + std::string(1 + random() % 9, 'x')
                                 : bytes.substr(0, random() % bytes.size());
      },
      200);
}

TEST(DiskCache, AFileUnderAnothersNameIsAMiss) {
  const TempFolder folder;
  DiskCache cache(folder.path());
  const Buffer a = mesh_of(3), b = mesh_of(4);
  cache.store(key(1), a);
  cache.store(key(2), b);
  const auto name = [&](int i) {
    const std::string hex = to_hex(key(i));
    return fs::path(folder.path()) / "objects" / hex.substr(0, 2) / (hex + ".buffer");
  };
  fs::copy_file(name(1), name(2), fs::copy_options::overwrite_existing);
  EXPECT_FALSE(load(cache, 2, b));
  EXPECT_THAT(cache.take_warnings(),
              testing::ElementsAre(testing::Pair("cache_damaged", HasSubstr("it is removed"))));
  fs::remove(name(1));
  fs::create_symlink("/dev/zero", name(1));
  EXPECT_FALSE(load(cache, 1, a)) << "a link is no file of ours";
  const BufferType* images[] = {&buffer_type<Image>()};
  cache.store(key(2), b);
  EXPECT_FALSE(cache.load(key(2), images)) << "another kind than the port gives";
}

TEST(DiskCache, ABufferWhoseColumnWasEvictedIsAMissWithoutAWord) {
  const TempFolder folder;
  DiskCache(folder.path()).store(key(1), mesh_of(3));
  for (const fs::path& f : objects(folder.path()))
    if (f.extension() == ".column") fs::remove(f);
  DiskCache cache(folder.path());
  EXPECT_FALSE(load(cache, 1, mesh_of(3)));
  EXPECT_THAT(cache.take_warnings(), IsEmpty());
  EXPECT_EQ(cache.store(key(1), mesh_of(3)), DiskCache::Store::stored);
  EXPECT_TRUE(load(cache, 1, mesh_of(3)));
}

TEST(DiskCache, EvictsWhatWasUsedLongestAgo) {
  const TempFolder folder;
  const Buffer image = picture<Image>(100, 50);
  const auto pause = [] { std::this_thread::sleep_for(std::chrono::milliseconds(15)); };
  DiskCache(folder.path()).store(key(0), image);
  const std::uint64_t one = fs::file_size(objects(folder.path()).front());
  {
    DiskCache cache(folder.path(), 5 * one + one / 2);
    for (int i = 1; i < 5; ++i) pause(), cache.store(key(i), image);
    pause();
    EXPECT_TRUE(load(cache, 0, image)) << "used again, it is the youngest";
    EXPECT_THAT(objects(folder.path()), SizeIs(5));
    pause();
    EXPECT_EQ(cache.store(key(5), image), DiskCache::Store::stored);
  }
  DiskCache cache(folder.path());
  std::set<int> left;
  for (int i = 0; i < 6; ++i)
    if (cache.contains(key(i))) left.insert(i);
  EXPECT_EQ(left, (std::set<int>{0, 3, 4, 5})) << "as many as nine tenths of the limit hold";
  EXPECT_EQ(DiskCache(folder.path(), one).store(key(9), image), DiskCache::Store::too_large);
}

TEST(DiskCache, RemovesWhatAProcessLeftHalfWritten) {
  const TempFolder folder;
  DiskCache cache(folder.path());
  const std::string temporary = folder.path() + "/tmp";
  write_file(temporary + "/old", "x");
  write_file(temporary + "/new", "x");
  fs::last_write_time(temporary + "/old", fs::file_time_type::clock::now() - std::chrono::hours(2));
  cache.evict();
  EXPECT_FALSE(fs::exists(temporary + "/old"));
  EXPECT_TRUE(fs::exists(temporary + "/new")) << "somebody may be writing it";
}

// A file system of its own, as large as stated; not there where the system does not allow mounting.
class TinyDisk {
 public:
  explicit TinyDisk(const char* options)
      : mounted_(::mount("tmpfs", path().c_str(), "tmpfs", 0, options) == 0) {}
  ~TinyDisk() {
    if (mounted_) ::umount2(path().c_str(), MNT_DETACH);
  }
  std::string path() const { return folder_.path(); }
  bool mounted() const { return mounted_; }
  bool make_read_only() const {
    return ::mount("tmpfs", path().c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr) == 0;
  }

 private:
  TempFolder folder_;
  bool mounted_;
};

TEST(DiskCache, AFullDiskEndsStoringWithOneWarning) {
  const TinyDisk disk("size=400k");
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small file system needs a right that this process has not";
  DiskCache cache(disk.path());
  const Buffer image = picture<Image>(100, 50);
  int stored = 0, refused = 0;
  for (int i = 0; i < 6; ++i) {
    const auto done = cache.store(key(i), image);
    stored += done == DiskCache::Store::stored ? 1 : 0;
    refused += done == DiskCache::Store::disabled ? 1 : 0;
  }
  EXPECT_EQ(stored, 2) << "160 kB each";
  EXPECT_EQ(refused, 4);
  EXPECT_THAT(cache.take_warnings(),
              testing::ElementsAre(testing::Pair("cache_disk_full", HasSubstr("is full"))));
  EXPECT_EQ(load(cache, 0, image).digest(), image.digest());
  EXPECT_TRUE(fs::is_empty(disk.path() + "/tmp")) << "nothing half-written stays";
}

TEST(DiskCache, AReadOnlyFolderIsReadAndSaidOnce) {
  const TinyDisk disk("size=1m");
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small file system needs a right that this process has not";
  const Buffer image = picture<Image>();
  DiskCache(disk.path()).store(key(1), image);
  ASSERT_TRUE(disk.make_read_only());
  DiskCache cache(disk.path());
  EXPECT_TRUE(load(cache, 1, image));
  EXPECT_EQ(cache.store(key(2), image), DiskCache::Store::disabled);
  EXPECT_EQ(cache.store(key(3), image), DiskCache::Store::disabled);
  EXPECT_THAT(cache.take_warnings(),
              testing::ElementsAre(testing::Pair("cache_read_only", HasSubstr("nothing more is stored"))));
}

TEST(DiskCache, AFolderThatCannotBeIsAWorldError) {
  const TempFolder folder;
  write_file(folder.file("file"), "");
  EXPECT_THROW(DiskCache(folder.file("file")), WorldError);
  EXPECT_THROW(DiskCache(folder.file("file") + "/below"), WorldError);
}

}  // namespace
}  // namespace frustum::test
