#pragma once

#include <open62541/client.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <optional>

#include "metier/base/clock.hpp"
#include "metier/opcua/status_code.hpp"

namespace metier::opcua {

/// Deadline of a call, and the length of its time-out.
struct Deadline {
    SteadyTime at = SteadyTime::max();
    std::chrono::milliseconds allowed{};

    static Deadline in(std::chrono::milliseconds allowed) {
        return {std::chrono::steady_clock::now() + allowed, allowed};
    }
};

/// The requests that the stack has sent and that wait for their answers.
///
/// An entry outlives its deadline until the stack returns it, because the stack takes an answer
/// that it does not expect for an attack and ends the connection.
///
/// Threading: the client's thread.
class ClientCalls {
public:
    /// End of a call.
    struct Ending {
        StatusCode status;         ///< the service result, or why there is none
        void* response = nullptr;  ///< none: no answer came
        bool sent = true;          ///< false: the request never left
    };
    /// Callback for the end of a call; called once.
    using Finish = std::function<void(const Ending&)>;
    struct Call {
        ClientCalls* calls = nullptr;
        Finish finish;  // empty: ended
        std::list<Call>::iterator self;
        std::multimap<SteadyTime, Call*>::iterator due;
    };

    ClientCalls() = default;
    ClientCalls(const ClientCalls&) = delete;
    ClientCalls& operator=(const ClientCalls&) = delete;

    /// To be given to the stack as user data of onResponse().
    Call& add(SteadyTime deadline, Finish finish);
    /// Forgets a call that the stack does not have.
    void drop(Call& call);
    /// Ends a call that the stack did not take, and forgets it.
    void refuse(Call& call, StatusCode status);
    static void onResponse(UA_Client* client, void* call, UA_UInt32 request, void* response);

    /// Ends the calls whose deadline has passed with BadTimeout.
    void expire(SteadyTime now);
    /// Ends all calls.
    void failAll(StatusCode status);
    std::optional<SteadyTime> nextDeadline() const;
    /// Unanswered requests, ended ones too.
    std::size_t size() const noexcept { return calls_.size(); }

private:
    static void end(Call& call, const Ending& ending);

    std::list<Call> calls_;
    std::multimap<SteadyTime, Call*> due_;  // calls that have not ended
};

}  // namespace metier::opcua
