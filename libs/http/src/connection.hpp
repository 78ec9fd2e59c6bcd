#pragma once

#include "metier/http/httplib.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/http/http_limits.hpp"

namespace metier::http {

/// The socket of one browser, on which every wait has a deadline and every request an end.
///
/// Threading: one thread.
class Connection final : public httplib::Stream {
public:
    /// \param socket stays the caller's
    Connection(int socket, const HttpLimits& limits);

    /// Waits for the first byte of a request.
    /// \return false: none came within HttpLimits::idle_time, or the peer has closed the connection
    bool awaitRequest();
    /// Starts a request: its time and size count against the limits from now on.
    void beginRequest();
    /// Its head is complete; now its body counts.
    /// \param length of the body [byte]; none: the head does not say for certain where it ends
    void beginBody(std::optional<std::size_t> length);
    /// Skips what nobody has read of the body. \return false: there is no telling where another
    /// request begins, or the rest does not come, so this was the last one
    bool endRequest();

    // Interface of httplib. A read beyond a limit fails, as if the peer had closed the connection.
    bool is_readable() const override;
    /// Whether something can be sent within HttpLimits::send_time to a peer that is there.
    bool is_writable() const override;
    ssize_t read(char* bytes, size_t size) override;
    ssize_t write(const char* bytes, size_t size) override;
    void get_remote_ip_and_port(std::string& ip, int& port) const override;
    void get_local_ip_and_port(std::string& ip, int& port) const override;
    int socket() const override { return socket_; }

private:
    /// Events of poll(2) that came; 0 at the deadline.
    short waitFor(short events, std::chrono::milliseconds longest) const;
    bool fill();

    const int socket_;
    const HttpLimits limits_;
    std::array<char, 4096> buffer_{};
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
    std::size_t budget_ = 0;  // [bytes] that may still be read
    SteadyTime deadline_{};   // of the request
    // [bytes] that come before the next request; none: nobody knows
    std::optional<std::size_t> rest_;
};

}  // namespace metier::http
