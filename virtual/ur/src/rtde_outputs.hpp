#pragma once

#include <span>
#include <string_view>

#include "rtde_variables.hpp"

namespace metier::virtual_ur {

/// An output and how it is read; what it reads has its type.
struct RtdeOutput {
    std::string_view name;
    RtdeVariable::Read read;
};

/// Every output that has no number.
std::span<const RtdeOutput> rtdeOutputs();

}  // namespace metier::virtual_ur
