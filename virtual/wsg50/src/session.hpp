#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "frame.hpp"
#include "gripper.hpp"

namespace metier::virtual_wsg50 {

/// Data that outlive a connection, besides the gripper itself.
struct Identity {
    std::uint32_t serial = 1;
    std::string tag;
};

/// One client's connection: answers its commands and sends the updates it asked for.
///
/// Threading: one thread.
class Session {
public:
    using Send = std::function<void(std::span<const std::byte>)>;

    /// \param gripper and \param identity outlive the session
    Session(Gripper& gripper, Identity& identity, Send send);

    /// Whatever came, in any parts.
    void receive(std::span<const std::byte> bytes);
    /// A motion ended.
    void finished(Command command, Status status) { reply(command, status, {}); }
    /// Sends the updates that are due after so much more time.
    void step(std::chrono::milliseconds elapsed);
    /// Reports whether the client has announced its disconnection.
    bool disconnectAnnounced() const noexcept { return disconnect_announced_; }

private:
    struct Update {
        Command command;
        std::uint32_t period = 0;  // [ms]; 0: none wanted
        std::uint32_t waited = 0;  // [ms]
        bool only_changes = false;
        std::vector<std::byte> last{};
    };

    void handle(const Frame& frame);
    void answer(Command command, std::span<const std::byte> payload);
    void answerMotion(Command command, std::span<const std::byte> payload);
    void answerStop(Command command, std::span<const std::byte> payload);
    void answerSetting(Command command, std::span<const std::byte> payload);
    void answerQuery(Command command, std::span<const std::byte> payload);
    void answerUpdate(Command command, std::span<const std::byte> payload);
    std::vector<std::byte> value(Command command) const;
    void reply(Command command, Status status, std::span<const std::byte> data);

    Gripper& gripper_;
    Identity& identity_;
    Send send_;
    FrameReader reader_;
    std::array<Update, 5> updates_;
    bool disconnect_announced_ = false;
};

}  // namespace metier::virtual_wsg50
