#pragma once

#include <cstdint>
#include <string>

#include "database.hpp"

namespace metier::records {

/// Store::exportTo() of a store of either kind.
Result<std::uint64_t> exportTo(Database& from, const std::string& file);

}  // namespace metier::records
