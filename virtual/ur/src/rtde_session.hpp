#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "rtde_variables.hpp"

namespace metier::virtual_ur {

/// Version number of URControl.
struct ControllerVersion {
    std::uint32_t major = 0;
    std::uint32_t minor = 0;
    std::uint32_t bugfix = 0;
    std::uint32_t build = 0;
};

/// Data shared by the RTDE sessions of one controller.
struct RtdeShared {
    ControllerVersion version;
    double rate = 125.0;  ///< cycles per second
    RtdeInputs inputs;
    /// Inputs of these names were just written.
    std::function<void(const std::vector<std::string>& names)> written;
    /// Inputs that some client claimed, all names together.
    std::set<std::string, std::less<>> claimed;
};

/// One client of port 30004: protocol version 1 until it negotiates 2.
///
/// Threading: one thread. Neither `shared` nor `peer` is used after the peer was closed.
class RtdeSession {
public:
    RtdeSession(RtdeShared& shared, virtual_controller::TcpPeer& peer);
    /// Gives its inputs free.
    ~RtdeSession();
    RtdeSession(const RtdeSession&) = delete;
    RtdeSession& operator=(const RtdeSession&) = delete;

    /// Takes bytes as they came.
    /// Errors: invalid_argument if they cannot be packages; the peer has to be cut then.
    Result<void> receive(std::span<const std::byte> bytes);
    /// Sends what this cycle is due.
    void cycle(const RobotState& state);

private:
    struct InputRecipe {
        std::vector<std::string> names;
        std::vector<RtdeVariable> variables;
        std::size_t size = 0;
    };
    struct OutputRecipe {
        std::vector<RtdeVariable> variables;
        std::uint64_t every = 1;  // cycles between two packages
    };

    void handle(char type, std::span<const std::byte> payload);
    void negotiate(ByteReader payload);
    void setUpOutputs(ByteReader payload);
    void setUpInputs(std::string_view list);
    void takeInputs(ByteReader payload);
    void answerVersion();
    void answerStart();
    void sendPackage(char type, std::span<const std::byte> payload);
    void answer(char type, std::uint8_t value);
    /// \param level 0 exception, 1 error, 2 warning, 3 information
    void sendText(std::uint8_t level, std::string_view text);

    RtdeShared& shared_;
    virtual_controller::TcpPeer& peer_;
    Bytes received_;
    unsigned protocol_ = 1;
    OutputRecipe outputs_;
    std::uint64_t cycles_ = 0;  // cycles since the start
    bool started_ = false;
    std::vector<InputRecipe> inputs_;  // the first has id 1
    std::set<std::string, std::less<>> claimed_;
};

}  // namespace metier::virtual_ur
