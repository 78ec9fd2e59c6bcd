#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace metier::system_tests {

using Bytes = std::vector<char>;

/// A TCP relay on loopback between one client at a time and a server, which keeps what the client
/// has sent, can cut the connection, and can send to the server in the client's name.
/// What cannot be set up throws std::system_error.
///
/// Threading: one thread of its own moves the bytes; any thread may call.
class Relay {
public:
    explicit Relay(std::uint16_t server_port);
    ~Relay();
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;

    std::string url() const;
    /// Ends the connection without a word of the client; a new one may follow.
    void cut();
    /// All that the client has sent over its present, or last, connection.
    Bytes sent() const;
    /// Sends more over the present connection, between two messages of the client.
    /// \return false if there is none
    bool inject(const Bytes& bytes);

private:
    void run(const std::stop_token& stop);
    void accept();
    void forward(int from, int to);
    void closeBoth();
    void wake() const;

    std::uint16_t server_port_;
    int listener_ = -1;
    int wake_ = -1;
    std::uint16_t port_ = 0;
    mutable std::mutex mutex_;
    // Guarded by mutex_:
    int client_ = -1;
    int server_ = -1;
    bool cut_ = false;
    Bytes sent_;
    std::jthread thread_;
};

/// Sends bytes to a server as a client of its own would, and reads until the server closes.
/// \return what it answered
Bytes sendAlone(std::uint16_t server_port, const Bytes& bytes);

}  // namespace metier::system_tests
