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

RemoteWorld::RemoteWorld(asio::io_context& context, std::string name, std::string address,
                         std::uint16_t port)
    : name_(std::move(name)), socket_(context), retry_(context), incoming_(kLongestLine) {
    asio::error_code ignored;
    endpoint_ = {asio::ip::make_address(address, ignored), port};
    connect();
}

/// A handler that calls `then` if its operation went well.
template <typename Then>
auto RemoteWorld::orConnectLater(Then then) {
    return [this, then](const asio::error_code& error, auto...) {
        if (error == asio::error::operation_aborted) {
            return;  // the world may be destroyed
        }
        if (error) {
            connectLater();
        } else {
            then();
        }
    };
}

void RemoteWorld::connect() {
    asio::error_code ignored;
    socket_.close(ignored);
    incoming_.consume(incoming_.size());
    connected_ = false;
    awaiting_ = false;
    socket_.async_connect(endpoint_, orConnectLater([this] {
                              asio::error_code also_ignored;
                              socket_.set_option(asio::ip::tcp::no_delay(true), also_ignored);
                              connected_ = true;
                              send();
                          }));
}

void RemoteWorld::connectLater() {
    connected_ = false;
    effect_ = {};
    retry_.expires_after(kRetry);
    retry_.async_wait([this](const asio::error_code& error) {
        if (!error) {
            connect();
        }
    });
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
    outgoing_ = toLine({name_, newest_});
    asio::async_write(socket_, asio::buffer(outgoing_), orConnectLater([this] { readEffect(); }));
}

void RemoteWorld::readEffect() {
    asio::async_read_until(socket_, incoming_, '\n', orConnectLater([this] {
                               std::istream stream(&incoming_);
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
