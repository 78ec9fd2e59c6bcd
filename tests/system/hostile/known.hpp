#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "writer.hpp"

namespace metier::hostile {

/// The nodes of a server that is attacked, as a well-behaved client found them.
struct AddressMap {
    struct Method {
        Bytes object;
        Bytes method;
    };
    std::vector<Bytes> nodes;
    std::vector<Bytes> variables;
    std::vector<Method> methods;
};

/// Facts that a hostile client has read from the server.
struct Known {
    const AddressMap& map;
    std::string endpoint_url;
    /// Policy of the anonymous token, as the endpoints give it.
    std::string anonymous_policy = "anonymous#None";
    Bytes authentication_token = standardId(0);
    std::vector<std::uint32_t> subscriptions{};
    std::vector<std::uint32_t> items{};
    Bytes continuation_point{};
};

}  // namespace metier::hostile
