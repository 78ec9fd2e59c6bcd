#pragma once

#include <asio/execution_context.hpp>
#include <cstddef>

namespace metier::virtual_controller {

/// Number of TCP connections that are open in an io_context, of all its ports.
///
/// Threading: the thread that runs the io_context.
class OpenConnections final : public asio::execution_context::service {
public:
    static asio::execution_context::id id;  // identifies the service for Asio

    explicit OpenConnections(asio::execution_context& context)
        : asio::execution_context::service(context) {}
    static OpenConnections& of(asio::execution_context& context) {
        return asio::use_service<OpenConnections>(context);
    }

    std::size_t count = 0;

private:
    void shutdown() noexcept override {}
};

}  // namespace metier::virtual_controller
