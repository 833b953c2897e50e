// A line plot as SVG text.
#pragma once

#include "physics/report.h"

namespace cairn::report {

/// Axes with ticks, curves with marks, a legend. Points that a logarithmic axis cannot show are left out.
std::string svg(const Axes& axes, const std::vector<Curve>& curves);

}  // namespace cairn::report
