#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/client.hpp"
#include "metier/skill/program_observer.hpp"
#include "skill_nodes.hpp"
#include "state_poll.hpp"

namespace metier::client {

/// Longest time for which the event of an end may come after the state that shows it.
inline constexpr std::chrono::milliseconds kEventTime{200};

/// The transitions of one skill as they arrive, numbered from 0; the newest thousand are kept.
///
/// Threading: add...() on the client's thread, forgetState() while none of them may run, the rest
/// on any.
class TransitionLog {
public:
    /// Callbacks for what arrives; each may be empty. On the client's thread.
    struct Watch {
        std::function<void(const skill::TransitionEvent&)> on_transition{};
        std::function<void()> on_missed{};  ///< transitions may have been missed
        std::function<void(const std::string& why)> on_ended{};  ///< nothing will come any more
    };

    void add(const opcua::EventNotice& notice);
    /// Adds an event of a server that does not name executions. It is also a doubt: the event may
    /// be of an execution before, so who waits looks at the state.
    void addNameless(const opcua::EventNotice& notice);
    /// Adds the state of a skill that sends no events: the transitions from the state before, also
    /// those that went by unseen.
    void addState(skill::State state, UtcTime time);
    /// Has addState() begin anew: the state before is of no use, as after a restart of the server.
    void forgetState() { state_.reset(); }
    /// Text of the newest transition, if it leads to `state`; else empty.
    std::string textOfLast(skill::State state) const;
    /// Counts a doubt, without any event.
    void doubt();
    void watch(Watch watch);

    /// A point in what arrives.
    struct Mark {
        std::uint64_t number = 0;  ///< number of the next transition
        std::uint64_t doubts = 0;  ///< times that transitions may have been missed before
    };
    Mark mark() const;

    struct Found {
        std::uint64_t number = 0;
        skill::TransitionEvent event;
    };
    /// The first transition from `from` on that `wanted` accepts. Nothing, if transitions may have
    /// been missed since: the server lost some, or the connection was away and is back. Who waits
    /// then looks what has become of the skill, and waits again from the present doubts.
    /// Errors: timeout at the deadline; connection_lost when nothing will come any more.
    opcua::Answer<std::optional<Found>> await(
        Mark from, SteadyTime deadline,
        const std::function<bool(const skill::TransitionEvent&)>& wanted);

private:
    struct News {
        std::optional<skill::TransitionEvent> event{};
        std::optional<opcua::StatusCode> ended{};
        bool doubt = false;
    };
    void take(const News& news);
    std::optional<Found> findFrom(
        std::uint64_t from, const std::function<bool(const skill::TransitionEvent&)>& wanted) const;
    void append(skill::TransitionEvent event);

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<skill::TransitionEvent> events_;
    std::uint64_t first_number_ = 0;
    std::uint64_t doubts_ = 0;
    std::optional<opcua::StatusCode> ended_;
    std::optional<skill::State> state_;  // that addState() added last
    Watch watch_;
};

/// Has `on_stopping` called when a skill begins to come to rest, on the client's thread.
/// Errors: the server's, also if it raises no such events.
opcua::Answer<opcua::Subscription> watchStopping(
    opcua::Client& client, const opcua::NodeId& skill,
    std::function<void(const skill::StoppingEvent&)> on_stopping);

/// Sources of a skill's transitions.
struct TransitionWatch {
    std::vector<opcua::Subscription> subscriptions{};
    StatePolling polling{};  ///< instead, if the server has no subscriptions
    bool events = false;     ///< the skill sends events
};

/// Subscribes to the transitions of a skill; each is added to the log. A skill that does not name
/// its executions is also watched by its state, or by it alone if it sends no events. At a server
/// without subscriptions the state is read again and again.
///
/// Errors: the server's.
opcua::Answer<TransitionWatch> watchTransitions(opcua::Client& client, const opcua::NodeId& skill,
                                                const SkillNodes& nodes,
                                                std::shared_ptr<TransitionLog> log);

}  // namespace metier::client
