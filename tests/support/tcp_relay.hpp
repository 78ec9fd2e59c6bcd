#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "metier/base/clock.hpp"

namespace metier::testing {

/// A small network: passes on the data for a port of this machine, until it is asked to misbehave.
///
/// Threading: any thread; one of its own does the work.
class TcpRelay {
public:
    /// \param target port on loopback that is relayed to; it need not listen yet
    explicit TcpRelay(std::uint16_t target);
    ~TcpRelay();
    TcpRelay(const TcpRelay&) = delete;
    TcpRelay& operator=(const TcpRelay&) = delete;

    std::uint16_t port() const { return port_; }
    std::string url() const { return "opc.tcp://127.0.0.1:" + std::to_string(port_); }

    /// From now on all data is passed on. Connections that have lost bytes are closed.
    void pass();
    /// All connections are closed, and new ones at once.
    void cut();
    /// All connections are closed; new ones are passed on.
    void interrupt();
    /// Connections stay open and new ones open, but every byte is swallowed.
    void stall();

    enum class Moment {
        before,  ///< it does not get there
        after,   ///< it gets there, and its answer is lost
    };
    /// cut() as soon as a client sends a message with these bytes in it.
    void cutAt(std::string bytes, Moment moment);
    /// Waits until cutAt() has cut; false at the deadline.
    bool awaitCut(SteadyTime deadline);

    /// Bytes that the newest client has sent over its connection.
    std::string sent() const;
    /// Sends more to the server over the newest connection, between two messages of its client.
    /// \return false if that connection is closed
    bool inject(const std::string& bytes);

private:
    enum class Mode { pass, cut, stall };
    struct Wire {
        int client = -1;
        int server = -1;
        bool damaged = false;
    };

    void run();
    void set(Mode mode);
    void accept();
    bool move(Wire& wire, int from);
    bool mustCut(const std::string& bytes) const;
    static void close(const Wire& wire);
    void closeAll();

    const std::uint16_t target_;
    int listener_ = -1;
    int wake_ = -1;
    std::uint16_t port_ = 0;
    mutable std::mutex mutex_;
    std::condition_variable cut_;
    Mode mode_ = Mode::pass;
    bool stopping_ = false;
    std::string trigger_;  // empty: none
    Moment moment_ = Moment::before;
    bool triggered_ = false;
    std::map<int, Wire> wires_;  // by the client's socket
    int newest_ = -1;            // the client's socket of the newest connection
    std::string sent_;           // by that client
    std::jthread thread_;
};

}  // namespace metier::testing
