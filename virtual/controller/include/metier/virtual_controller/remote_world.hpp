#pragma once

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>
#include <asio/streambuf.hpp>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "metier/virtual_controller/lifetime.hpp"
#include "metier/virtual_controller/world_link.hpp"

namespace metier::virtual_controller {

/// The world in a process of its own (virtual/world), reached by lines of JSON over TCP: each
/// report is answered by one effect. While the world cannot be reached there is no effect, and
/// connecting is tried again.
///
/// Threading: created, used and destroyed on the thread that runs the io_context. Nothing waits.
///
/// Connecting is tried again every 500 ms, for ever. An error and a line of more than 4096 bytes
/// end the connection; a line that is no effect is skipped, and the last effect stays.
class RemoteWorld final : public WorldLink {
public:
    /// TCP port of the world, unless another one is given.
    static constexpr std::uint16_t kPort = 7410;

    /// Begins to connect.
    /// \param context must outlive this
    /// \param name    name of this controller in the world's settings
    /// \param address IP address of the world's process
    /// \param port TCP port of the world's process
    /// An address that cannot be parsed is not reported here: check it with parseAddress() before.
    RemoteWorld(asio::io_context& context, std::string name, const std::string& address,
                std::uint16_t port = kPort);
    /// Closes the connection; handlers that are still queued do nothing.
    ~RemoteWorld() override;
    RemoteWorld(const RemoteWorld&) = delete;
    RemoteWorld& operator=(const RemoteWorld&) = delete;

    /// Sends the newest report as soon as the world has answered the one before; older ones are
    /// dropped.
    void report(const WorldReport& report) override;
    /// Newest effect; an empty one while the world cannot be reached.
    const WorldEffect& effect() const override { return effect_; }

private:
    /// Socket and buffers of the connection. They must live until the last operation on them has
    /// ended, also if the RemoteWorld is gone by then.
    struct Wire {
        Wire(asio::io_context& context, std::size_t longest_line)
            : socket(context), incoming(longest_line) {}

        asio::ip::tcp::socket socket;
        asio::streambuf incoming;
        std::string outgoing;
    };

    /// Handler that goes on with `then`, or with connectLater() after an error.
    template <typename Then>
    auto orConnectLater(Then then);
    /// Drops the present connection and whatever was received, and opens a new one.
    void connect();
    /// The world is gone: there is no effect from now on; the next attempt follows after the pause.
    void connectLater();
    /// Sends newest_ if there is something new, a connection and no answer outstanding.
    void send();
    /// Waits for the line that answers the last report, then sends the next one.
    void readEffect();

    std::string name_;
    // All members belong to the thread of the io_context; there is no lock.
    asio::ip::tcp::endpoint endpoint_;
    std::shared_ptr<Wire> wire_;  // shared with its operations, which may end after this
    asio::steady_timer retry_;
    WorldReport newest_;
    WorldEffect effect_;
    bool connected_ = false;
    bool unsent_ = false;    // newest_ has not been sent
    bool awaiting_ = false;  // waits for an effect
    Lifetime lifetime_;
};

/// A world without objects: nothing is touched, no part is between the jaws.
///
/// Threading: as WorldLink; has no connection and no state.
class EmptyWorld final : public WorldLink {
public:
    void report(const WorldReport&) override {}
    const WorldEffect& effect() const override { return effect_; }

private:
    WorldEffect effect_;
};

}  // namespace metier::virtual_controller
