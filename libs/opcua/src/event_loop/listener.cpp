#include "listener.hpp"

#include <asio/ip/v6_only.hpp>
#include <utility>

namespace metier::opcua {

namespace {

using asio::ip::tcp;

std::vector<tcp::endpoint> resolve(asio::io_context& io, const std::string& host,
                                   std::uint16_t port) {
    if (host.empty()) {
        return {{asio::ip::address_v4::any(), port}, {asio::ip::address_v6::any(), port}};
    }
    asio::error_code error;
    const auto found =
        tcp::resolver(io).resolve(host, std::to_string(port), tcp::resolver::passive, error);
    std::vector<tcp::endpoint> endpoints;
    for (const auto& entry : found) {
        endpoints.push_back(entry.endpoint());
    }
    return endpoints;
}

asio::error_code openAcceptor(tcp::acceptor& acceptor, const tcp::endpoint& endpoint) {
    asio::error_code error;
    acceptor.open(endpoint.protocol(), error);
    if (!error && endpoint.address().is_v6()) {
        acceptor.set_option(asio::ip::v6_only(true), error);
    }
    if (!error) {  // SO_REUSEADDR: connections of a dead process do not keep the port
        acceptor.set_option(asio::socket_base::reuse_address(true), error);
    }
    if (!error) {
        acceptor.bind(endpoint, error);
    }
    if (!error) {
        acceptor.listen(asio::socket_base::max_listen_connections, error);
    }
    return error;
}

std::string nameOf(const std::string& host, std::uint16_t port) {
    return (host.empty() ? "all interfaces" : host) + ", port " + std::to_string(port);
}

/// Listens on every address of one host, on the same port, which is chosen if it is 0.
Result<> listenOn(asio::io_context& io, const std::string& host, std::uint16_t& port,
                  std::vector<OpenAcceptor>& opened) {
    std::string reason = "the name is not known";
    bool listening = false;
    for (auto endpoint : resolve(io, host, port)) {
        endpoint.port(port);
        tcp::acceptor acceptor(io);
        const auto error = openAcceptor(acceptor, endpoint);
        if (error == asio::error::address_in_use) {
            return fail(Errc::already_exists,
                        "cannot listen on " + nameOf(host, port) + ": " + error.message());
        }
        if (error) {  // e.g. no IPv6 here; enough if another address of the host works
            reason = error.message();
            continue;
        }
        port = acceptor.local_endpoint().port();
        opened.push_back({std::move(acceptor), {host, port}});
        listening = true;
    }
    if (!listening) {
        return fail(Errc::not_found, "cannot listen on " + nameOf(host, port) + ": " + reason);
    }
    return {};
}

}  // namespace

void Listener::close() {
    closing = true;
    asio::error_code ignored;  // nothing more can be done
    acceptor.close(ignored);
    timer.cancel();
}

Result<std::vector<OpenAcceptor>> openAcceptors(asio::io_context& io,
                                                const TcpParameters& parameters) {
    auto hosts = parameters.addresses;
    if (hosts.empty()) {
        hosts.emplace_back();
    }
    auto port = parameters.port;
    std::vector<OpenAcceptor> opened;
    for (const auto& host : hosts) {
        METIER_TRY(listenOn(io, host, port, opened));
    }
    return opened;
}

}  // namespace metier::opcua
