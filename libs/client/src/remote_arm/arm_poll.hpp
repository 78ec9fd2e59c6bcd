#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/skill/state.hpp"
#include "program_state.hpp"
#include "remote_arm/notes.hpp"
#include "remote_arm/published_arm.hpp"

namespace metier::client {

/// Reads an arm and the state of its stream skill again and again, one request at a time, for
/// servers that do not publish them as metier's do. All values of one answer are of one moment, and
/// a server that is silent is noticed: after 2 s without an answer the connection counts as broken.
///
/// Threading: one owner; may end before its client, whose late answers then change nothing.
class ArmPoll {
public:
    /// \param arm     its axes and stops are read if it has no Kinematics
    /// \param program nodes of the stream skill; none: its state is not read
    ArmPoll(opcua::Client& client, const PublishedArm& arm, std::optional<ProgramNodes> program,
            std::shared_ptr<Notes> notes);

    /// Asks, unless an answer is awaited or was asked for less than `period` ago. Does not wait.
    void ask(std::chrono::nanoseconds period);
    /// Asks and waits for the answer. Errors: those of the server; type_mismatch.
    Result<void> askAndWait();
    /// Whether a stop has no value that says whether it is pressed. After askAndWait(), before
    /// ask().
    bool hasUnknownStops() const;

private:
    struct Layout;
    struct Pending;
    std::vector<opcua::ReadItem> items_;
    opcua::Client& client_;
    std::shared_ptr<Layout> layout_;  // shared with answers that are under way, as both below
    std::shared_ptr<Pending> pending_;
    std::shared_ptr<Notes> notes_;
};

}  // namespace metier::client
