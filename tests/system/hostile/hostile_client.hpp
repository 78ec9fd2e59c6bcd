#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chunks.hpp"
#include "known.hpp"
#include "raw_socket.hpp"
#include "secure_open.hpp"

namespace metier::hostile {

enum class ServerKind {
    open,    ///< lets anybody in
    closed,  ///< answers discovery alone, without security
};

/// Outcome of the messages.
struct Tally {
    std::uint64_t connections = 0;
    std::uint64_t answers = 0;
    std::uint64_t faults = 0;    ///< answers that refuse a whole request
    std::uint64_t sessions = 0;  ///< accepted sessions
    std::vector<std::string> defects;
};

/// Sends messages that are mostly right and wrong in some place. The content of a message depends
/// on the seed, its number, and on ids that the server sent before: of channels, sessions,
/// subscriptions.
///
/// Threading: one thread.
class HostileClient {
public:
    struct Target {
        std::uint16_t port = 0;
        std::string url;
        ServerKind kind = ServerKind::open;
        PublicCertificates certificates{};  ///< of a closed server
    };

    /// `map` and `tally` must outlive it.
    HostileClient(Target target, const AddressMap& map, Tally& tally);

    /// Sends the message of that number, and takes what has come.
    void send(std::uint64_t seed, std::uint64_t number);

private:
    enum class Stage { disconnected, connected, greeted, opened, created, active };

    void sendHello(Random& random);
    void sendOpen(Random& random, std::size_t wrong_one_in);
    void sendSession(Random& random, std::size_t wrong_one_in);
    void sendRequest(Random& random, std::size_t wrong_one_in);
    void sendOther(Random& random);
    void transmit(std::string_view bytes);
    void drop();

    /// Waits for what leads to the next stage.
    void awaitStage(Stage stage, std::size_t wrong_one_in);
    void receive(std::chrono::milliseconds longest);
    void take(std::string_view chunk);
    void takeOpened(std::string_view chunk);
    void takeMessage(std::string_view chunk);
    void judge(std::uint32_t type, std::uint32_t result, std::string_view content);

    const Target target_;
    Tally& tally_;
    Known known_;
    Channel channel_;
    RawSocket socket_;
    Bytes received_;
    Stage stage_ = Stage::disconnected;
    std::uint64_t number_ = 0;
    bool listens_ = true;
    bool in_parts_ = false;  // an answer came in several chunks, which is left out
    int attempts_ = 0;       // to activate its session
};

}  // namespace metier::hostile
