#pragma once

#include <asio/io_context.hpp>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "metier/urscript/robot.hpp"
#include "metier/virtual_controller/link_faults.hpp"

namespace metier::virtual_ur {

/// Sockets with which programs connect to addresses, not to names. A socket whose program leaves 1
/// MB unread is closed.
///
/// Threading: the thread that runs the io_context.
class ScriptSockets final : public urscript::Sockets {
public:
    /// \param address where they come from
    /// \param faults  outlives the sockets
    ScriptSockets(asio::io_context& context, std::string address,
                  virtual_controller::LinkFaults& faults);
    ~ScriptSockets() override;

    void open(const std::string& name, const std::string& host, int port) override;
    urscript::SocketState state(const std::string& name) const override;
    void close(const std::string& name) override;
    bool send(const std::string& name, std::string_view bytes) override;
    std::string_view received(const std::string& name) const override;
    void consume(const std::string& name, std::size_t count) override;
    /// Closes all sockets, as at the end of a program.
    void closeAll();

private:
    struct Socket;
    Socket* find(const std::string& name) const;

    asio::io_context& context_;
    const std::string address_;
    virtual_controller::LinkFaults& faults_;
    std::map<std::string, std::unique_ptr<Socket>> sockets_;
};

}  // namespace metier::virtual_ur
