#pragma once

#include <string>

namespace metier::skill {

/// Who calls.
struct Caller {
    std::string session_id{};
    std::string client_name{};
    std::string user_name{};
    std::string thumbprint{};  ///< of the certificate of its application; empty: none
    /// A skill of this server that runs others: what it may do was decided at its own Start.
    bool of_this_server = false;
};

}  // namespace metier::skill
