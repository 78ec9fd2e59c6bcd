#include "metier/skill/resource.hpp"

#include <fmt/format.h>

namespace metier::skill {

Result<void> Resource::checkFree() const {
    if (holder_.empty()) {
        return {};
    }
    return fail(Errc::resource_unavailable, fmt::format("{} is in use by {}", name_, holder_));
}

Result<void> Resource::acquire(std::string_view holder) {
    METIER_TRY(checkFree());
    holder_ = holder;
    return {};
}

}  // namespace metier::skill
