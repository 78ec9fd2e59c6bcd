#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace metier::hostile {

/// A TCP connection without any protocol. Nothing waits but where a time is given.
///
/// Threading: one thread.
class RawSocket {
public:
    RawSocket() = default;
    /// Takes over a socket that is connected.
    explicit RawSocket(int descriptor);
    ~RawSocket() { reset(); }
    RawSocket(const RawSocket&) = delete;
    RawSocket& operator=(const RawSocket&) = delete;
    RawSocket(RawSocket&& other) noexcept;
    RawSocket& operator=(RawSocket&& other) noexcept;

    /// Connects to 127.0.0.1; false if no server is there.
    bool connect(std::uint16_t port);
    bool isOpen() const { return descriptor_ >= 0; }
    /// Ends it at once, without what was not sent yet.
    void reset();

    /// Gives up, and closes, if the peer does not take it all in time, or has closed.
    void send(std::string_view bytes, std::chrono::milliseconds longest);
    /// Reports to the peer that nothing more follows; it may still send.
    void endSending();
    /// Appends what has come, or comes in time; closes if the peer has.
    void receive(std::string& into, std::chrono::milliseconds longest);

private:
    bool wait(short events, std::chrono::milliseconds longest) const;
    void takeOver(int descriptor);

    int descriptor_ = -1;
};

/// Listens on 127.0.0.1.
class RawListener {
public:
    /// On a free port. Throws if there is none.
    RawListener();
    ~RawListener();
    RawListener(const RawListener&) = delete;
    RawListener& operator=(const RawListener&) = delete;

    std::uint16_t port() const { return port_; }
    /// The next connection; one that is not open if none comes in time.
    RawSocket accept(std::chrono::milliseconds longest) const;

private:
    int descriptor_;
    std::uint16_t port_ = 0;
};

}  // namespace metier::hostile
