#pragma once

#include <array>
#include <cstddef>

#include "metier/iiwa_driver/wire.hpp"

namespace metier::iiwa_driver {

/// Commands that wait to be sent, one per answer.
class CommandList {
public:
    static constexpr std::size_t kCapacity = 12;

    /// Adds a command; one beyond the capacity is dropped, but no list here is that long.
    void add(const Command& command) noexcept {
        if (end_ < kCapacity) {
            commands_[end_++] = command;
        }
    }
    bool empty() const noexcept { return begin_ == end_; }
    const Command& front() const noexcept { return commands_[begin_]; }
    void drop() noexcept { ++begin_; }
    void clear() noexcept { begin_ = end_ = 0; }

private:
    std::array<Command, kCapacity> commands_{};
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

/// Settings that were sent to the cabinet, so that none is sent twice.
///
/// Threading: one thread, the cycle. Nothing allocates.
class CabinetSettings {
public:
    /// Adds `command` unless the cabinet already has just this setting.
    void require(const Command& command, CommandList& list) const noexcept;
    /// The cabinet executed it.
    void taken(const Command& command) noexcept;
    /// The cabinet refused it: what it has now is not known.
    void refused(const Command& command) noexcept;
    /// Nothing is known any more.
    void forget() noexcept { count_ = 0; }

private:
    static constexpr std::size_t kCapacity = 12;

    const Command* find(Code code) const noexcept;

    std::array<Command, kCapacity> known_{};
    std::size_t count_ = 0;
};

}  // namespace metier::iiwa_driver
