#pragma once

#include <functional>
#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/client.hpp"

namespace metier::dashboard {

/// How this program connects to servers. The functions are called from any thread.
struct Connector {
    /// As secure as that server wants it, as this program's own user.
    /// Errors: told on the page.
    std::function<Result<opcua::ClientOptions>(const std::string& url)> options;
    /// What a person can do about a connection that was refused; begins with "; ", or is empty.
    std::function<std::string(const opcua::Failure&)> advice;
    /// Called after a connection to a server was made with these options; may be empty.
    std::function<void(const opcua::ClientOptions&, const std::string& url)> connected{};
};

}  // namespace metier::dashboard
