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
class RemoteWorld final : public WorldLink {
public:
    /// TCP port of the world, unless another one is given.
    static constexpr std::uint16_t kPort = 7410;

    /// Begins to connect.
    /// \param context must outlive this
    /// \param name    name of this controller in the world's settings
    /// \param address IP address of the world's process
    RemoteWorld(asio::io_context& context, std::string name, std::string address,
                std::uint16_t port = kPort);
    ~RemoteWorld() override;
    RemoteWorld(const RemoteWorld&) = delete;
    RemoteWorld& operator=(const RemoteWorld&) = delete;

    /// Sends the newest report as soon as the world has answered the one before; older ones are
    /// dropped.
    void report(const WorldReport& report) override;
    /// Newest effect; an empty one while the world cannot be reached.
    const WorldEffect& effect() const override { return effect_; }

private:
    struct Wire {
        Wire(asio::io_context& context, std::size_t longest_line)
            : socket(context), incoming(longest_line) {}

        asio::ip::tcp::socket socket;
        asio::streambuf incoming;
        std::string outgoing;
    };

    template <typename Then>
    auto orConnectLater(Then then);
    void connect();
    void connectLater();
    void send();
    void readEffect();

    std::string name_;
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
class EmptyWorld final : public WorldLink {
public:
    void report(const WorldReport&) override {}
    const WorldEffect& effect() const override { return effect_; }

private:
    WorldEffect effect_;
};

}  // namespace metier::virtual_controller
