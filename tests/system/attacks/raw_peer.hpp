#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"

namespace metier::system_tests {

/// WireBytes in the binary encoding of OPC UA (OPC 10000-6, 5.2).
class WireBytes {
public:
    template <typename Number>
    WireBytes& put(Number number) {
        bytes_.append(reinterpret_cast<const char*>(&number), sizeof(number));  // NOLINT
        return *this;
    }
    WireBytes& text(std::string_view text);
    WireBytes& nothing() { return put(std::int32_t{-1}); }  ///< a null String or array
    WireBytes& raw(std::string_view bytes);
    WireBytes& node(std::uint16_t number);                             ///< id of namespace 0
    WireBytes& node(std::uint16_t name_space, std::string_view text);  ///< text id
    const std::string& str() const { return bytes_; }

private:
    std::string bytes_;
};

/// Numbers of requests' encodings (OPC 10000-6, A.3).
namespace request {
inline constexpr std::uint16_t kOpenSecureChannel = 446;
inline constexpr std::uint16_t kCreateSession = 461;
inline constexpr std::uint16_t kActivateSession = 467;
inline constexpr std::uint16_t kCloseSession = 473;
inline constexpr std::uint16_t kBrowse = 527;
inline constexpr std::uint16_t kRead = 631;
inline constexpr std::uint16_t kWrite = 673;
inline constexpr std::uint16_t kCall = 712;
inline constexpr std::uint16_t kCreateMonitoredItems = 751;
inline constexpr std::uint16_t kCreateSubscription = 787;
inline constexpr std::uint16_t kPublish = 826;
}  // namespace request

/// To create a Session. \param nonce of the client, of any length
WireBytes sessionOf(std::chrono::milliseconds timeout, std::string_view nonce = {});
/// Session time-out in a server's answer.
std::chrono::milliseconds sessionTimeout(const std::string& answer);

/// A peer on a plain socket, which speaks OPC UA without security as far as an attack needs it, and
/// reads only on request.
///
/// Threading: one thread. Nothing waits for longer than `patience`.
class RawPeer {
public:
    /// \param host IPv4 address. \param receive_buffer [byte] of the socket, 0: as it is
    /// \param patience longest wait for what the server sends or takes
    RawPeer(const std::string& host, std::uint16_t port, int receive_buffer = 0,
            std::chrono::seconds patience = std::chrono::seconds(1));
    ~RawPeer();
    RawPeer(RawPeer&& other) noexcept;
    RawPeer& operator=(RawPeer&& other) noexcept;
    RawPeer(const RawPeer&) = delete;
    RawPeer& operator=(const RawPeer&) = delete;

    bool connected() const { return socket_ >= 0; }
    /// Returns whether the server went along, as the next ones do.
    bool hello();
    bool openChannel();
    /// An anonymous session. \param activate or only created
    bool createSession();
    bool activateSession();
    /// All of the above.
    bool logIn() { return hello() && openChannel() && createSession() && activateSession(); }

    /// Sends a request and does not read its answer.
    /// \return false if the server has closed the connection
    bool request(std::uint16_t type, const WireBytes& body);
    /// Sends a request and reads its answer; nothing if there is none in time.
    /// \return the body, behind its ResponseHeader, of a Good one
    std::optional<std::string> ask(std::uint16_t type, const WireBytes& body);
    /// The same. \return the StatusCode of the answer, or of the ERR that came instead; that of
    /// BadTimeout if nothing came
    std::uint32_t statusOf(std::uint16_t type, const WireBytes& body);
    /// The same with the message in so many chunks.
    std::uint32_t statusInChunks(std::uint16_t type, const WireBytes& body, std::size_t chunks);
    void closeSession();
    /// The body of the last answer that was read, behind its ResponseHeader.
    const std::string& answer() const { return answer_; }
    /// Sends a chunk that is not the last of its message. \param size [byte] with its header
    bool intermediateChunk(std::size_t size);
    bool send(std::string_view bytes);
    /// Reads and drops what is there, without waiting. \return [byte]; nothing once it is closed
    std::optional<std::size_t> drain();
    /// The same after a wait for it; nothing also if nothing came.
    std::optional<std::size_t> drainSome();

private:
    std::string chunk(std::string_view type, std::uint16_t request, const WireBytes& body);
    std::string chunkOf(std::string_view type, std::uint32_t request, std::string_view content);
    std::string headerOf(std::uint16_t request);
    std::uint32_t readStatus();
    std::optional<std::string> receive();
    bool fill(std::string& bytes);
    void hangUp();

    int socket_ = -1;
    std::uint32_t channel_ = 0;
    std::uint32_t token_ = 0;
    std::uint32_t sequence_ = 0;
    std::string answer_{};
    std::string authentication_{'\0', '\0'};  // a null NodeId
};

}  // namespace metier::system_tests
