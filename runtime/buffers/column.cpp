#include "runtime/buffers/column.h"

#include "runtime/buffers/numbers.h"
#include "runtime/core/pages.h"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <mutex>
#include <new>
#include <stdexcept>

namespace frustum {
namespace {

constexpr std::array domain_names{"vertex", "corner", "face", "mesh"};
constexpr std::array kind_names{"f32", "f64", "i32", "u32"};

constexpr std::align_val_t cache_line{64};
constexpr std::size_t large = 256 * 1024;  // from here on blocks are mapped, and kept

std::shared_ptr<void> aligned_storage(std::size_t rows, std::size_t row_bytes) {
  const auto fail = [&] {
    throw WorldError("out_of_memory",
                     fmt::format("no memory for a column of {} rows of {} bytes", rows, row_bytes));
  };
  if (rows > std::numeric_limits<std::size_t>::max() / 2 / row_bytes) fail();
  if (rows * row_bytes >= large) try {
      auto pages = std::make_shared<Pages>(rows * row_bytes, Contents::anything);
      return {pages, pages->data()};
    } catch (const std::bad_alloc&) {
      fail();
    }
  void* p = ::operator new(rows* row_bytes, cache_line, std::nothrow);
  if (p == nullptr) fail();
  return {p, [](void* data) { ::operator delete(data, cache_line); }};
}

}  // namespace

struct Column::HealthMemo {
  std::once_flag once;
  Health health;
};

std::string_view name_of(Domain d) { return domain_names[static_cast<std::size_t>(d)]; }
std::string_view name_of(NumberKind k) { return kind_names[static_cast<std::size_t>(k)]; }

Column::Column(std::string_view name, Domain domain, NumberKind kind, int width, std::size_t rows,
               Space space)
    : Column(name, domain, kind, width, rows, space,
             aligned_storage(rows, static_cast<std::size_t>(width) * bytes_of(kind))) {}

Column::Column(std::string_view name, Domain domain, NumberKind kind, int width, std::size_t rows,
               Space space, std::shared_ptr<void> storage)
    : name_(name),
      domain_(domain),
      kind_(kind),
      width_(width),
      rows_(rows),
      space_(space),
      data_(std::move(storage)),
      health_(std::make_shared<HealthMemo>()) {}

double Column::number(std::size_t row, int component) const {
  const std::size_t i = row * static_cast<std::size_t>(width_) + static_cast<std::size_t>(component);
  switch (kind_) {
    case NumberKind::f32: return static_cast<const float*>(data_.get())[i];
    case NumberKind::f64: return static_cast<const double*>(data_.get())[i];
    case NumberKind::i32: return static_cast<const std::int32_t*>(data_.get())[i];
    case NumberKind::u32: return static_cast<const std::uint32_t*>(data_.get())[i];
  }
  return 0;
}

Ref<Column> Column::renamed(std::string_view name, Space space) const {
  auto copy = std::make_shared<Column>(*this);
  copy->name_ = name;
  copy->space_ = space;
  return copy;
}

Health Column::health() const {
  std::call_once(health_->once, [this] { health_->health = count_health(); });
  return health_->health;
}

Health Column::count_health() const {
  const std::size_t n = rows_ * static_cast<std::size_t>(width_);
  Scan found;
  if (kind_ == NumberKind::f32) found = scan(std::span(static_cast<const float*>(data_.get()), n));
  if (kind_ == NumberKind::f64) found = scan(std::span(static_cast<const double*>(data_.get()), n));
  return to_health(found, n, [&](std::size_t i) {
    return fmt::format("column {}, {} {}", name_, name_of(domain_), i / static_cast<std::size_t>(width_));
  });
}

void Column::hash(Hasher& h) const {
  h.text(name_).value(domain_).value(kind_).value(width_).value(rows_).value(space_).bytes(data_.get(),
                                                                                           bytes());
}

void Column::save(ArchiveWriter& w) const {
  w.text(name_).value(domain_).value(kind_).value(width_).value(std::uint64_t{rows_}).value(space_);
  w.shared(data_, bytes());
}

Ref<Column> Column::load(ArchiveReader& r) {
  std::string name = r.text();
  const auto domain = r.choice(Domain::mesh);
  const auto kind = r.choice(NumberKind::u32);
  const int width = r.value<int>();
  const auto rows = r.value<std::uint64_t>();
  const auto space = r.choice(Space::screen);
  if (width < 1 || width > 4 || rows > std::numeric_limits<std::size_t>::max() / 64)
    throw ArchiveError("no such column");
  const std::size_t bytes = rows * static_cast<std::size_t>(width) * bytes_of(kind);
  return std::make_shared<Column>(name, domain, kind, width, rows, space, r.shared(bytes));
}

void Column::require(NumberKind kind, int width) const {
  if (kind == kind_ && width == width_) return;
  throw std::logic_error(fmt::format("column {} holds {} x {}, not {} x {}", name_, name_of(kind_), width_,
                                     name_of(kind), width));
}

Ref<Column> as_precision(Ref<Column> column, NumberKind real) {
  const NumberKind from = column->kind();
  if (from == real) return column;
  if (from == NumberKind::f64 && real == NumberKind::f32)
    throw NodeError(
        "narrowing",
        fmt::format("column {} is double and this node computes in single; narrowing loses digits, so it "
                    "is never silent: give this node or the graph precision \"double\"",
                    column->name()));
  if (from != NumberKind::f32 || real != NumberKind::f64)
    throw NodeError("wrong_column_type", fmt::format("column {} holds {}, where real numbers are needed",
                                                     column->name(), name_of(from)));
  auto wide = std::make_shared<Column>(column->name(), column->domain(), real, column->width(),
                                       column->rows(), column->space());
  const auto n = static_cast<std::ptrdiff_t>(column->rows()) * column->width();
  const auto* source = static_cast<const float*>(column->data());
  auto* target = static_cast<double*>(const_cast<void*>(wide->data()));
  std::copy(source, source + n, target);
  return wide;
}

}  // namespace frustum
