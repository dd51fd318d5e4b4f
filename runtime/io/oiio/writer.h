#pragma once

#include "runtime/io/sink_plan.h"

#include <memory>

namespace frustum::oiio {

std::unique_ptr<Sink> open(const SinkRequest& request, const SinkPlan& plan);

}  // namespace frustum::oiio
