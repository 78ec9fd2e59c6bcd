#include "metier/virtual_controller/tcp_server.hpp"

#include <fmt/format.h>

#include <asio/ip/tcp.hpp>
#include <utility>
#include <vector>

#include "metier/virtual_controller/lifetime.hpp"
#include "tcp_connection.hpp"

namespace metier::virtual_controller {
namespace {

using asio::ip::tcp;

class Port final : public TcpServer, private TcpConnectionOwner {
public:
    Port(tcp::acceptor acceptor, LinkFaults& link_faults, Handlers what_to_do)
        : TcpConnectionOwner(link_faults, std::move(what_to_do)), acceptor_(std::move(acceptor)) {
        accept();
    }

    std::uint16_t port() const override {
        asio::error_code ignored;
        return acceptor_.local_endpoint(ignored).port();
    }
    void forEach(const std::function<void(TcpPeer&)>& action) override { forEachPeer(action); }
    void resetAll() override {
        forEach([](TcpPeer& peer) { peer.reset(); });
    }

private:
    void accept() {
        acceptor_.async_accept(
            lifetime_.guard([this](const asio::error_code& error, tcp::socket socket) {
                if (!error && faults.cut.load()) {
                    unreachable_.push_back(std::move(socket));
                } else if (!error) {
                    unreachable_.clear();
                    take(std::move(socket));
                }
                accept();
            }));
    }

    tcp::acceptor acceptor_;
    std::vector<tcp::socket> unreachable_;  // dialled over a cut cable; never get an answer
    Lifetime lifetime_;
};

}  // namespace

Result<asio::ip::address> parseAddress(const std::string& text) {
    asio::error_code error;
    const auto address = asio::ip::make_address(text, error);
    if (error) {
        return fail(Errc::invalid_argument, fmt::format("\"{}\" is not an address", text));
    }
    return address;
}

Result<std::unique_ptr<TcpServer>> TcpServer::listen(asio::io_context& context, const Place& place,
                                                     LinkFaults& faults, Handlers handlers) {
    const auto name = fmt::format("{}:{}", place.address, place.port);
    METIER_ASSIGN(const auto parsed, parseAddress(place.address));
    asio::error_code error;
    tcp::acceptor acceptor(context);
    const tcp::endpoint endpoint(parsed, place.port);
    acceptor.open(endpoint.protocol(), error);
    acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    acceptor.bind(endpoint, error);
    if (!error) {
        acceptor.listen(tcp::acceptor::max_listen_connections, error);
    }
    if (error == asio::error::address_in_use) {
        return fail(Errc::already_exists, name + ": another program listens there");
    }
    if (error == asio::error::access_denied) {
        return fail(Errc::access_denied, name + ": ports below 1024 need root");
    }
    if (error) {
        return fail(Errc::invalid_argument, name + ": " + error.message());
    }
    return std::make_unique<Port>(std::move(acceptor), faults, std::move(handlers));
}

}  // namespace metier::virtual_controller
