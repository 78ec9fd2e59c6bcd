#include "cabinet_settings.hpp"

#include <algorithm>
#include <cmath>

namespace metier::iiwa_driver {

namespace {

bool isSetting(Code code) noexcept {
    return static_cast<int>(code) > static_cast<int>(Code::move_pose);
}

bool sameNumber(double a, double b) noexcept {
    return a == b || (std::isnan(a) && std::isnan(b));
}

bool sameArguments(const Command& a, const Command& b) noexcept {
    return std::equal(a.arguments.begin(), a.arguments.end(), b.arguments.begin(), sameNumber);
}

}  // namespace

const Command* CabinetSettings::find(Code code) const noexcept {
    const auto* end = known_.data() + count_;
    const auto* found =
        std::find_if(known_.data(), end, [code](const Command& c) { return c.code == code; });
    return found == end ? nullptr : found;
}

void CabinetSettings::require(const Command& command, CommandList& list) const noexcept {
    const auto* known = find(command.code);
    if (known == nullptr || !sameArguments(*known, command)) {
        list.add(command);
    }
}

void CabinetSettings::taken(const Command& command) noexcept {
    if (!isSetting(command.code)) {
        return;
    }
    if (const auto* known = find(command.code)) {
        known_[static_cast<std::size_t>(known - known_.data())] = command;
    } else if (count_ < kCapacity) {
        known_[count_++] = command;
    }
}

void CabinetSettings::refused(const Command& command) noexcept {
    if (const auto* known = find(command.code)) {
        known_[static_cast<std::size_t>(known - known_.data())] = known_[--count_];
    }
}

}  // namespace metier::iiwa_driver
