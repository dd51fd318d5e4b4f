#pragma once

#include "runtime/core/raster.h"
#include "runtime/io/sink_plan.h"

#include <memory>
#include <string>
#include <string_view>

namespace frustum::oiio {

std::string encode_png(const Raster& picture, int bits, std::string_view name);

std::unique_ptr<Sink> open(const SinkRequest& request, const SinkPlan& plan);

}  // namespace frustum::oiio
