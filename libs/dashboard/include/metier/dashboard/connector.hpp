#pragma once

#include <functional>
#include <memory>
#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/client.hpp"

namespace metier::server {
class ForeignRecords;
}  // namespace metier::server

namespace metier::dashboard {

/// Settings for connections of this program to servers. The functions are called on any thread,
/// several at a time; they may wait for the disk and the network.
struct Connector {
    /// Options for a connection as secure as that server wants it, as this program's own user.
    /// Errors: shown on the page.
    std::function<Result<opcua::ClientOptions>(const std::string& url)> options;
    /// Advice for a person after a refused connection; begins with "; ", or is empty.
    std::function<std::string(const opcua::Failure&)> advice;
    /// Called after a connection to a server was made with these options; may be empty.
    std::function<void(const opcua::ClientOptions&, const std::string& url)> connected{};
    /// Records of what is started from the page at servers that record nothing themselves; null:
    /// none.
    std::shared_ptr<server::ForeignRecords> foreign_records{};
};

}  // namespace metier::dashboard
