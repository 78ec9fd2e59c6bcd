#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "metier/base/error.hpp"

namespace metier::skill {

/// A device that only one Program may use at a time: from its Start until it is Ready or Halted.
/// Give the same one to the ProgramOptions of all skills of the device.
///
/// Threading: the owner's thread, which all its Programs share.
///
///     auto arm = std::make_shared<Resource>("arm ur5");
///     Program move({.resource = arm}, std::move(move_skill), executor, clock);
///     Program push({.resource = arm}, std::move(push_skill), executor, clock);
///     // While `move` is Running or Suspended, a Start of `push` is resource_unavailable.
class Resource {
public:
    /// \param name for messages: "arm ur5"
    explicit Resource(std::string name) : name_(std::move(name)) {}
    Resource(const Resource&) = delete;
    Resource& operator=(const Resource&) = delete;

    /// Name of the device, as in refusals.
    const std::string& name() const noexcept { return name_; }
    /// BrowseName of the skill that holds it; empty if none does.
    const std::string& holder() const noexcept { return holder_; }

    /// Checks that nobody holds it.
    /// Errors: resource_unavailable, with the holder's name.
    Result<void> checkFree() const {
        return holder_.empty() ? Result<void>()
                               : fail(Errc::resource_unavailable,
                                      fmt::format("{} is in use by {}", name_, holder_));
    }
    /// Takes the device for the skill of that BrowseName.
    /// Errors: resource_unavailable if it is held, even by `holder` itself.
    /// \param holder BrowseName of the skill, not empty: an empty one would leave it free
    Result<void> acquire(std::string_view holder) {
        METIER_TRY(checkFree());
        holder_ = holder;
        return {};
    }
    /// Frees the device, whoever holds it; nothing happens if it is free.
    /// Only its holder should call it: nothing checks that.
    void release() noexcept { holder_.clear(); }

private:
    std::string name_;
    std::string holder_;
};

}  // namespace metier::skill
