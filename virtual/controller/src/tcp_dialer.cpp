#include "metier/virtual_controller/tcp_dialer.hpp"

#include <fmt/format.h>

#include <asio/ip/tcp.hpp>
#include <asio/post.hpp>
#include <utility>

#include "metier/virtual_controller/lifetime.hpp"
#include "tcp_connection.hpp"

namespace metier::virtual_controller {
namespace {

using asio::ip::tcp;

class Dialer final : public TcpDialer, private TcpConnectionOwner {
public:
    Dialer(tcp::socket socket, std::pair<tcp::endpoint, tcp::endpoint> from_and_to,
           LinkFaults& link_faults, Handlers what_to_do)
        : TcpConnectionOwner(link_faults, std::move(what_to_do.peer)),
          socket_(std::move(socket)),
          from_(std::move(from_and_to.first)),
          to_(std::move(from_and_to.second)),
          on_failed_(std::move(what_to_do.on_failed)) {}

    void dial() override {
        asio::error_code error;
        socket_.close(error);
        socket_.open(to_.protocol(), error);
        if (!error && from_.address().is_loopback() && to_.address().is_loopback()) {
            socket_.bind(from_, error);
        }
        if (error) {
            asio::post(socket_.get_executor(),
                       lifetime_.guard([this, error] { failed(error.message()); }));
            return;
        }
        socket_.async_connect(to_, lifetime_.guard([this](const asio::error_code& refused) {
            if (refused != asio::error::operation_aborted) {
                connected(refused);
            }
        }));
    }
    void reset() override {
        asio::error_code ignored;
        socket_.close(ignored);
        forEachPeer([](TcpPeer& peer) { peer.reset(); });
    }

private:
    void connected(const asio::error_code& refused) {
        if (refused) {
            failed(refused.message());
        } else if (faults.cut.load()) {
            asio::error_code ignored;
            socket_.close(ignored);
            failed("no answer");
        } else {
            take(std::move(socket_));
        }
    }
    void failed(const std::string& why) {
        if (on_failed_) {
            on_failed_({Errc::connection_lost,
                        fmt::format("{}:{}: {}", to_.address().to_string(), to_.port(), why)});
        }
    }

    tcp::socket socket_;
    tcp::endpoint from_;
    tcp::endpoint to_;
    std::function<void(const Error&)> on_failed_;
    Lifetime lifetime_;
};

}  // namespace

Result<std::unique_ptr<TcpDialer>> TcpDialer::create(asio::io_context& context, const Route& route,
                                                     LinkFaults& faults, Handlers handlers) {
    METIER_ASSIGN(const auto from, parseAddress(route.from));
    METIER_ASSIGN(const auto to, parseAddress(route.to));
    if (route.port == 0) {
        return fail(Errc::invalid_argument, "port 0 cannot be dialled");
    }
    return std::make_unique<Dialer>(
        tcp::socket(context), std::pair(tcp::endpoint(from, 0), tcp::endpoint(to, route.port)),
        faults, std::move(handlers));
}

}  // namespace metier::virtual_controller
