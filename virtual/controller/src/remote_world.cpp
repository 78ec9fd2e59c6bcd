#include "metier/virtual_controller/remote_world.hpp"

#include <asio/read_until.hpp>
#include <asio/write.hpp>
#include <istream>
#include <utility>

#include "metier/virtual_controller/world_messages.hpp"

namespace metier::virtual_controller {
namespace {

constexpr std::chrono::milliseconds kRetry{500};
constexpr std::size_t kLongestLine = 4096;

}  // namespace

RemoteWorld::RemoteWorld(asio::io_context& context, std::string name, const std::string& address,
                         std::uint16_t port)
    : name_(std::move(name)),
      wire_(std::make_shared<Wire>(context, kLongestLine)),
      retry_(context) {
    asio::error_code ignored;
    endpoint_ = {asio::ip::make_address(address, ignored), port};
    connect();
}

RemoteWorld::~RemoteWorld() {
    asio::error_code ignored;
    wire_->socket.close(ignored);
}

/// A handler that calls `then` if its operation went well.
template <typename Then>
auto RemoteWorld::orConnectLater(Then then) {
    return lifetime_.guard([this, then, wire = wire_](const asio::error_code& error, auto...) {
        if (error) {
            connectLater();
        } else {
            then();
        }
    });
}

void RemoteWorld::connect() {
    asio::error_code ignored;
    wire_->socket.close(ignored);
    wire_->incoming.consume(wire_->incoming.size());
    connected_ = false;
    awaiting_ = false;
    wire_->socket.async_connect(endpoint_, orConnectLater([this] {
                                    asio::error_code also_ignored;
                                    wire_->socket.set_option(asio::ip::tcp::no_delay(true),
                                                             also_ignored);
                                    connected_ = true;
                                    send();
                                }));
}

void RemoteWorld::connectLater() {
    connected_ = false;
    effect_ = {};
    retry_.expires_after(kRetry);
    retry_.async_wait(lifetime_.guard([this](const asio::error_code&) { connect(); }));
}

void RemoteWorld::report(const WorldReport& report) {
    newest_ = report;
    unsent_ = true;
    send();
}

void RemoteWorld::send() {
    if (!connected_ || awaiting_ || !unsent_) {
        return;
    }
    awaiting_ = true;
    unsent_ = false;
    wire_->outgoing = toLine({name_, newest_});
    asio::async_write(wire_->socket, asio::buffer(wire_->outgoing),
                      orConnectLater([this] { readEffect(); }));
}

void RemoteWorld::readEffect() {
    asio::async_read_until(wire_->socket, wire_->incoming, '\n', orConnectLater([this] {
                               std::istream stream(&wire_->incoming);
                               std::string line;
                               std::getline(stream, line);
                               if (const auto effect = effectOf(line)) {
                                   effect_ = *effect;
                               }
                               awaiting_ = false;
                               send();
                           }));
}

}  // namespace metier::virtual_controller
