#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client_calls.hpp"
#include "client_config.hpp"
#include "client_services.hpp"
#include "client_subscriptions.hpp"
#include "event_loop.hpp"
#include "metier/opcua/client.hpp"

namespace metier::opcua {

/// What is being done, for messages, and until when.
struct Task {
    std::string doing;
    Deadline deadline;
};

/// Frees a client of the stack; runs its event loop, so never in one of its callbacks.
struct DeleteClient {
    void operator()(UA_Client* client) const noexcept { UA_Client_delete(client); }
};

/// One client of the stack with its event loop and the thread that runs both.
///
/// The stack's callbacks never call out: what users are told is queued with later() and said
/// between two iterations of the loop, when the stack is not at work and none of its locks is held.
class ClientCore {
public:
    ClientCore(ClientOptions options, ClientPurpose purpose);
    /// Closes.
    ~ClientCore();
    ClientCore(const ClientCore&) = delete;
    ClientCore& operator=(const ClientCore&) = delete;

    // Any thread.

    /// Connects and waits for the outcome; once. After a failure it is closed.
    /// For a session the outcome is its own; for discovery, what settle() is told.
    Answer<> connect(const std::string& url);
    /// Before connect(), for discovery: what to do whenever the SecureChannel is open. The stack
    /// may open several until it is content with the server's address.
    void whenOpen(std::function<void()> work) { when_open_ = std::move(work); }
    /// Ends connection and thread, and waits for that. Not on the own thread.
    void close();
    Client::State state() const noexcept { return state_; }
    bool onOwnThread() const noexcept { return own_thread_ == std::this_thread::get_id(); }
    const ClientOptions& options() const noexcept { return options_; }
    Deadline deadline(Timeout timeout) const;
    /// Runs work on the own thread, which it wakes. Errors: connection_lost (after close()).
    Answer<> post(std::function<void()> work);
    /// As post(), also refused once the connection is lost.
    Answer<> request(std::function<void()> work);
    void onConnectionLost(std::function<void(const Failure&)> callback);

    // The own thread.

    /// Sends a request and hears of its outcome once, in the stack: valid is what the pointer
    /// leads to only then. Fails at once if the deadline has passed or there is no connection.
    template <typename Request>
    void send(Request& request, Task task, OnResponse<Request> done);
    /// Runs call_out when the stack is not at work.
    void later(std::function<void()> call_out) { call_outs_.push_back(std::move(call_out)); }
    /// Ends connect(), unless it has ended.
    void settle(Answer<> outcome);
    ClientSubscriptions& subscriptions() noexcept { return subscriptions_; }

private:
    struct Message {
        void* request;
        const UA_DataType* request_type;
        const UA_DataType* response_type;
    };

    void run();
    void begin();
    void iterate(std::chrono::milliseconds longest);
    void sayEverything();
    void end();
    UA_SecureChannelState channelState() const;
    void sendMessage(const Message& message, SteadyTime deadline, ClientCalls::Finish finish);
    Failure failure(const Task& task, StatusCode status) const;
    void refuse(StatusCode status);
    void lose(StatusCode status);
    void stateChanged(UA_SecureChannelState channel, UA_SessionState session, StatusCode status);
    void connectingChanged(UA_SecureChannelState channel, UA_SessionState session,
                           StatusCode status);
    static void onState(UA_Client* client, UA_SecureChannelState channel, UA_SessionState session,
                        UA_StatusCode status);
    static void onInactivity(UA_Client* client);

    const ClientOptions options_;
    const ClientPurpose purpose_;
    std::atomic<Client::State> state_ = Client::State::connected;
    std::atomic<std::thread::id> own_thread_;
    std::promise<Answer<>> connected_;
    std::mutex gate_;  // orders post() and close()
    bool closed_ = false;
    std::mutex joining_;

    // The own thread's, once it runs.
    ClientComplaints complaints_;
    AsioEventLoop loop_;
    ClientCalls calls_;
    ClientSubscriptions subscriptions_;
    std::vector<std::function<void()>> call_outs_;
    std::unique_ptr<UA_Client, DeleteClient> client_;
    ClientCalls::Call* connecting_ = nullptr;  // none: settled
    UA_SecureChannelState channel_ = UA_SECURECHANNELSTATE_CLOSED;
    int attempts_ = 0;
    std::string url_;
    std::function<void()> when_open_;
    bool ending_ = false;
    std::optional<Failure> lost_;
    std::function<void(const Failure&)> on_lost_;

    std::jthread thread_;
};

template <typename Request>
void ClientCore::send(Request& request, Task task, OnResponse<Request> done) {
    using Types = Service<Request>;
    const Message message{&request, &UA_TYPES[Types::kRequest], &UA_TYPES[Types::kResponse]};
    const auto deadline = task.deadline.at;
    sendMessage(
        message, deadline,
        [this, task = std::move(task), done = std::move(done)](StatusCode result, void* response) {
            if (result.isBad()) {
                done(tl::unexpected(failure(task, result)));
            } else {
                done(static_cast<typename Types::Response*>(response));
            }
        });
}

}  // namespace metier::opcua
