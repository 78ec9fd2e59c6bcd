#pragma once

#include <string>

namespace metier::skill {

/// Who calls.
struct Caller {
    std::string session_id{};
    std::string client_name{};
    std::string user_name{};
};

}  // namespace metier::skill
