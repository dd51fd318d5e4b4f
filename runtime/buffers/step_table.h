// What an algorithm did, step by step, as a table that does not outgrow what people read.
#pragma once

#include "runtime/buffers/value.h"
#include "runtime/core/context.h"

#include <fmt/format.h>

#include <memory>
#include <utility>
#include <vector>

namespace frustum {

// The first `limit` rows that are added, numbered from 1 in the column "step".
class StepTable {
 public:
  StepTable(std::vector<Table::Column> columns, int limit)
      : table_(std::make_shared<Table>()), limit_(static_cast<std::size_t>(limit)) {
    table_->columns = std::move(columns);
    table_->columns.insert(table_->columns.begin(), Table::Column{.name = "step"});
  }

  bool full() const { return table_->columns[0].numbers.size() >= limit_; }

  // A row that is not made since the table is full.
  void leave_out() { ++left_out_; }

  // A row: a number or a text for each column after the first, in order.
  template <class... Cells>
  void add(Cells&&... cells) {
    if (full()) return leave_out();
    std::size_t column = 0;
    table_->columns[0].numbers.push_back(static_cast<double>(table_->columns[0].numbers.size() + 1));
    (put(table_->columns[++column], std::forward<Cells>(cells)), ...);
  }
  // The table, which is the node's output of that number; warns where somebody reads it and it does not hold all rows.
  Ref<Table> table(Context& ctx, std::size_t output) const {
    if (left_out_ > 0 && ctx.wants(output))
      ctx.warn("table_cut", fmt::format("the table has the first {} of {} rows: 'rows' lists more", limit_,
                                        limit_ + left_out_));
    return table_;
  }

 private:
  static void put(Table::Column& c, std::string text) { c.texts.push_back(std::move(text)); }
  template <class T>
  requires std::is_arithmetic_v<T>
  static void put(Table::Column& c, T number) { c.numbers.push_back(static_cast<double>(number)); }

  std::shared_ptr<Table> table_;
  std::size_t limit_, left_out_ = 0;
};

}  // namespace frustum
