#pragma once

#include <string_view>

namespace metier::edo_driver {

/// Where the texts for the robot go.
class Wire {
public:
    virtual ~Wire() = default;
    /// Sends one text. A failure is noticed by whoever owns the link, as its loss.
    virtual void send(std::string_view text) noexcept = 0;
};

}  // namespace metier::edo_driver
