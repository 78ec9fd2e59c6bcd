#pragma once

#include <filesystem>

#include "../bench_server.hpp"
#include "metier/opcua/security.hpp"
#include "metier/security/identity.hpp"

namespace metier::hostile {

inline constexpr const char* kServerUri = "urn:metier:server";
inline constexpr const char* kOperator = "operator";
inline constexpr const char* kPassword = "the password of a test";

/// Makes a server's and a client's identity in `folder`, each trusted by the other.
/// Throws if it cannot.
void makeIdentities(const std::filesystem::path& folder);

/// For a server, and for a client, that take what makeIdentities() left there.
opcua::ServerSecurity securityIn(const std::filesystem::path& folder);
opcua::ClientOptions clientOptionsIn(const std::filesystem::path& folder);

}  // namespace metier::hostile
