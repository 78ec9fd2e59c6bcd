#pragma once

#include <string_view>

namespace metier::edo_driver {

/// Receiver of the texts for the robot.
class Wire {
public:
    virtual ~Wire() = default;
    /// Sends one text. The owner of the link notices a failure as the loss of the link.
    virtual void send(std::string_view text) noexcept = 0;
};

}  // namespace metier::edo_driver
