#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/client_calls.hpp"
#include "client/client_config.hpp"
#include "client/client_reconnection.hpp"
#include "client/client_services.hpp"
#include "client/client_subscriptions.hpp"
#include "event_loop.hpp"
#include "metier/opcua/client.hpp"

namespace metier::opcua {

/// Effect of a request on the server.
enum class Effect { asks, commands };

/// Name of an action, for messages, and its deadline.
struct Task {
    std::string doing;
    Deadline deadline;
    Effect effect = Effect::asks;
};

/// Frees a client of the stack; runs its event loop, so never in one of its callbacks.
struct DeleteClient {
    void operator()(UA_Client* client) const noexcept { UA_Client_delete(client); }
};

/// One client of the stack with its event loop and the thread that runs both.
///
/// The stack's callbacks never call user code: notifications are queued with later() and delivered
/// between two iterations of the loop, when the stack is not at work and none of its locks is held.
///
/// With a connection it is `open`. Without one it is `waiting` for the next attempt, then
/// `attempting` until there is a session with a known server, then `restoring` the subscriptions;
/// any failure leads back to `waiting`. `over` is the final state.
class ClientCore {
public:
    ClientCore(ClientOptions options, ConnectionKind kind);
    /// Closes.
    ~ClientCore();
    ClientCore(const ClientCore&) = delete;
    ClientCore& operator=(const ClientCore&) = delete;

    // Any thread.

    /// Connects and waits for the outcome; once. After a failure it is closed. For a session the
    /// outcome is that of the session; for discovery, the one given to settle().
    Answer<> connect(const std::string& url);
    /// Before connect(), for discovery: what to do whenever the SecureChannel is open. The stack
    /// may open several until it is content with the server's address.
    void whenOpen(std::function<void()> work) { when_open_ = std::move(work); }
    /// Ends connection and thread, and waits for that. Not on the own thread.
    void close();
    Client::State state() const noexcept { return state_; }
    std::uint64_t boot() const noexcept { return boot_; }
    std::optional<Failure> whyLost() const;
    /// Waits while it is reconnecting; false at the deadline.
    bool awaitChange(SteadyTime deadline) const;
    bool onOwnThread() const noexcept { return own_thread_ == std::this_thread::get_id(); }
    const ClientOptions& options() const noexcept { return options_; }
    Deadline deadline(Timeout timeout) const;
    /// Runs work on the own thread, which it wakes. Errors: connection_lost (after close()).
    Answer<> post(std::function<void()> work);
    /// As post(), for work that sends. Refused without a connection; what is posted to one
    /// connection is not sent by the next.
    Answer<> request(std::function<void()> work);
    /// As Client::runAfter().
    Answer<> runAfter(std::chrono::nanoseconds delay, std::function<void()> work);
    void onConnectionLost(std::function<void(const Failure&)> callback);
    void onConnectionChange(std::function<void(const ConnectionChange&)> callback);

    // The own thread.

    /// Sends a request. Its outcome is delivered once, by a callback within the stack; the pointer
    /// given there is valid only during that callback. Fails at once if the deadline has passed or
    /// there is no connection.
    template <typename Request>
    void send(Request& request, Task task, OnResponse<Request> done);
    /// Runs call_out when the stack is not at work.
    void later(std::function<void()> call_out) { call_outs_.push_back(std::move(call_out)); }
    /// Ends connect(), unless it has ended.
    void settle(Answer<> outcome);
    ClientSubscriptions& subscriptions() noexcept { return subscriptions_; }
    bool reconnects() const noexcept { return schedule_.has_value(); }

private:
    enum class Phase { connecting, open, waiting, attempting, restoring, over };
    struct Message {
        void* request;
        const UA_DataType* request_type;
        const UA_DataType* response_type;
    };

    void run();
    void connectNow();
    void iterate(std::chrono::milliseconds longest);
    SteadyTime nextDue() const;
    void runRequest(std::uint64_t connection, const std::function<void()>& work);
    void sayEverything();
    void runDelayed(SteadyTime until);
    void end();
    UA_SecureChannelState channelState() const;
    void sendMessage(const Message& message, SteadyTime deadline, ClientCalls::Finish finish);
    Failure failure(const Task& task, const ClientCalls::Ending& ending) const;
    void refuse(StatusCode status);
    void lose(StatusCode status);
    void loseForGood(const Failure& why);
    void setState(Client::State state);
    void tell(ConnectionChange change);

    // client_core_reconnect.cpp
    void interrupt(StatusCode status);
    void attemptIfDue();
    bool hasSession() const;
    void attempted(const Answer<>& outcome);
    void identify();
    void identified(const Answer<UA_ReadResponse*>& answer);
    void restore();
    void restored();
    void waitAgain(const Failure& why);

    void stateChanged(UA_SecureChannelState channel, UA_SessionState session, StatusCode status);
    void connectingChanged(UA_SecureChannelState channel, UA_SessionState session,
                           StatusCode status);
    bool isAsSecureAsWanted() const;
    static void onState(UA_Client* client, UA_SecureChannelState channel, UA_SessionState session,
                        UA_StatusCode status);
    static void onInactivity(UA_Client* client);

    const ClientOptions options_;
    const ConnectionKind kind_;
    std::atomic<Client::State> state_ = Client::State::connected;
    std::atomic<std::uint64_t> boot_ = 1;
    std::atomic<std::uint64_t> connection_ = 1;  // increased with each connection
    mutable std::mutex state_mutex_;
    mutable std::condition_variable state_changed_;
    std::optional<Failure> why_lost_;  // under state_mutex_
    std::atomic<std::thread::id> own_thread_;
    std::promise<Answer<>> connected_;
    std::mutex gate_;  // orders post() and close()
    bool closed_ = false;
    std::mutex joining_;

    // The own thread's, once it runs.
    std::unique_ptr<PeerCheck> peers_;  // for a connection with security
    ClientComplaints complaints_;
    AsioEventLoop loop_;
    ClientCalls calls_;
    ClientSubscriptions subscriptions_;
    std::vector<std::function<void()>> call_outs_;
    std::multimap<SteadyTime, std::function<void()>> delayed_;  // by the time at which it is due
    std::unique_ptr<UA_Client, DeleteClient> client_;
    ClientCalls::Call* connecting_ = nullptr;  // none: settled
    UA_SecureChannelState channel_ = UA_SECURECHANNELSTATE_CLOSED;
    int attempts_ = 0;
    std::string url_;
    std::function<void()> when_open_;
    bool ending_ = false;
    Phase phase_ = Phase::connecting;
    std::optional<ReconnectSchedule> schedule_;
    ServerIdentity server_;
    ServerIdentity found_;                     // by the present attempt
    bool identifying_ = false;                 // `found_` is being read
    bool session_kept_ = false;                // by the present attempt
    std::optional<Failure> outage_;            // while there is no connection
    std::optional<std::uint64_t> request_of_;  // connection of the request that is being sent
    std::function<void(const Failure&)> on_lost_;
    std::function<void(const ConnectionChange&)> on_change_;

    std::jthread thread_;
};

template <typename Request>
void ClientCore::send(Request& request, Task task, OnResponse<Request> done) {
    using Types = Service<Request>;
    const Message message{&request, &UA_TYPES[Types::kRequest], &UA_TYPES[Types::kResponse]};
    const auto deadline = task.deadline.at;
    sendMessage(
        message, deadline,
        [this, task = std::move(task), done = std::move(done)](const ClientCalls::Ending& ending) {
            if (ending.status.isBad()) {
                done(tl::unexpected(failure(task, ending)));
            } else {
                done(static_cast<typename Types::Response*>(ending.response));
            }
        });
}

}  // namespace metier::opcua
